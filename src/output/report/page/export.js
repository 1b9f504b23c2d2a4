"use strict";
// What is on the page as files: pictures as SVG and PNG, their data as CSV.

function save(name, content, type) {
  const url = content instanceof Blob ? URL.createObjectURL(content) : URL.createObjectURL(new Blob([content], { type }));
  const link = el("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

const fileName = (title, ending) => `${title.replace(/[^\p{L}\p{N}]+/gu, "_").replace(/^_+|_+$/g, "").slice(0, 80)}.${ending}`;

const saveSvg = (title, text) => save(fileName(title, "svg"), text, "image/svg+xml");
const saveCsv = (title, text) => save(fileName(title, "csv"), text, "text/csv");

/** A picture as PNG, with two pixels for one of the page. */
async function savePng(title, text) {
  const picture = new Image();
  picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await picture.decode();
  const canvas = el("canvas", { width: 2 * picture.width, height: 2 * picture.height });
  canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => save(fileName(title, "png"), blob));
}

/** The buttons that save a picture: what draws it as SVG, and what has its data as CSV. */
const exports = (title, svg, data) => [
  button("SVG", "Save the picture as SVG", () => saveSvg(title(), svg())),
  button("PNG", "Save the picture as PNG", () => savePng(title(), svg())),
  button("CSV", "Save what is in the picture as CSV", () => saveCsv(title(), data())),
];

/** A cell of a CSV file. */
const cell = (value) => {
  if (typeof value === "number") return Number.isFinite(value) ? String(value) : "NaN";
  if (value == null) return "";
  return /[",\n]/.test(value) ? `"${String(value).replaceAll('"', '""')}"` : String(value);
};

/** Columns of one length as CSV. */
function csv(names, columns) {
  const lines = [names.map(cell).join(",")];
  for (let k = 0; k < (columns[0] || []).length; k++) lines.push(columns.map((column) => cell(column[k])).join(","));
  return lines.join("\n") + "\n";
}

const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);

/** A text in lines of so many letters at most, as far as its words allow it. */
function wrapped(text, most) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const line = `${lines.at(-1)} ${word}`.trimStart();
    if (line.length <= most || !lines.at(-1)) lines[lines.length - 1] = line;
    else lines.push(word);
  }
  return lines;
}

/** A chart as it is seen, zoom included, in black on white. */
function svg(chart) {
  const { plot } = chart;
  const ratio = uPlot.pxRatio;
  const box = { x: plot.bbox.left / ratio, y: plot.bbox.top / ratio, w: plot.bbox.width / ratio, h: plot.bbox.height / ratio };
  const titles = wrapped(chart.title, (plot.width - box.x) / 8);
  const title = 6 + 18 * titles.length;
  const shown = plot.series.map((series, k) => ({ series, k })).filter(({ series, k }) => k > 0 && series.show);
  const listed = shown.filter(({ k }) => !chart.series[k - 1].unlisted);
  const height = plot.height + title + 18 * listed.length + 8;
  const parts = [];
  const text = (x, y, words, anchor = "middle", more = "") =>
    parts.push(`<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" text-anchor="${anchor}" ${more}>${escaped(words)}</text>`);
  titles.forEach((line, k) => text(box.x, 16 + 18 * k, line, "start", 'font-weight="bold" font-size="14"'));
  parts.push(`<g transform="translate(0 ${title})">`);
  const { x: bx, y: by, w, h } = box;
  plot.axes.forEach((axis, k) => {
    const values = axis._values || [];
    const splits = axis._splits || [];
    ((k === 0 ? chart.x : chart.y).log ? powers(splits) : splits).forEach((split, i) => {
      if (split == null) return;
      const at = plot.valToPos(split, axis.scale) + (k === 0 ? bx : by);
      if (k === 0 ? at < bx - 0.5 || at > bx + w + 0.5 : at < by - 0.5 || at > by + h + 0.5) return;
      const [x2, y2] = k === 0 ? [at, by] : [bx + w, at];
      const [x1, y1] = k === 0 ? [at, by + h] : [bx, at];
      parts.push(`<line x1="${x1.toFixed(1)}" y1="${y1.toFixed(1)}" x2="${x2.toFixed(1)}" y2="${y2.toFixed(1)}" stroke="#ddd"/>`);
      if (values[i] == null) return;
      if (k === 0) text(at, by + h + 16, values[i]);
      else text(bx - 6, at + 4, values[i], "end");
    });
  });
  parts.push(`<rect x="${bx}" y="${by}" width="${w}" height="${h}" fill="none" stroke="#444"/>`);
  text(bx + w / 2, by + h + 36, chart.x.label);
  // A label that is longer than its axis is written smaller.
  const size = Math.min(11.5, (11.5 * (h + by)) / (6.5 * chart.y.label.length)).toFixed(1);
  parts.push(`<text transform="translate(14 ${by + h / 2}) rotate(-90)" text-anchor="middle" font-size="${size}">${escaped(chart.y.label)}</text>`);
  parts.push(`<clipPath id="box"><rect x="${bx}" y="${by}" width="${w}" height="${h}"/></clipPath><g clip-path="url(#box)">`);
  for (const { series, k } of shown) {
    const colour = chart.series[k - 1].colour;
    const dashes = (chart.series[k - 1].dash || []).join(" ");
    if (chart.series[k - 1].points) parts.push(...spots(chart, k, box).filter(Boolean).map(([x, y]) => `<circle cx="${x.toFixed(1)}" cy="${y.toFixed(1)}" r="3.5" fill="${colour}"/>`));
    else parts.push(`<path d="${outline(chart, k, box)}" fill="none" stroke="${colour}" stroke-width="1.6" stroke-dasharray="${dashes}"/>`);
  }
  parts.push("</g></g>");
  listed.forEach(({ k }, i) => {
    const y = plot.height + title + 18 * i + 6;
    const { colour, name, dash } = chart.series[k - 1];
    parts.push(`<line x1="${bx}" x2="${bx + 26}" y1="${y}" y2="${y}" stroke="${colour}" stroke-width="2" stroke-dasharray="${(dash || []).join(" ")}"/>`);
    text(bx + 32, y + 4, name, "start");
  });
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${plot.width}" height="${height}" viewBox="0 0 ${plot.width} ${height}" ` +
    `font-family="sans-serif" font-size="11.5"><rect width="100%" height="100%" fill="white"/>${parts.join("\n")}</svg>\n`;
}

/** The points of a curve in pixels: `null` where it is broken. */
function spots(chart, k, box) {
  const [xs, ys] = [chart.plot.data[0], chart.plot.data[k]];
  const at = (x, y) => [box.x + chart.plot.valToPos(x, "x"), box.y + chart.plot.valToPos(y, "y")];
  return Array.from(xs, (x, i) => (ys[i] == null ? ys[i] : at(x, ys[i]))).filter((spot) => spot !== undefined);
}

/** The way of a curve in pixels. */
function outline(chart, k, box) {
  const way = [];
  let pen = "M";
  let last = "";
  for (const spot of spots(chart, k, box)) {
    if (!spot) {
      pen = "M";
      continue;
    }
    const place = spot.map((pixel) => pixel.toFixed(1)).join(" ");
    if (place !== last || pen === "M") way.push(pen + place);
    [pen, last] = ["L", place];
  }
  return way.join("");
}
