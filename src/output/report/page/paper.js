"use strict";
// Pictures that are drawn on a canvas, written down as SVG: what draws the one draws the other.

/** Takes what is asked of a canvas, as far as the pictures of the page ask for it. */
class Paper {
  constructor(width, height) {
    Object.assign(this, { width, height, parts: [], kept: [], clips: 0, way: "", dashes: [] });
    Object.assign(this, { fillStyle: "#000", strokeStyle: "#000", lineWidth: 1, font: "11px sans-serif", textAlign: "left" });
    Object.assign(this, { transform: "", clipped: "" });
  }

  save() {
    const { fillStyle, strokeStyle, lineWidth, font, textAlign, transform, clipped } = this;
    this.kept.push({ fillStyle, strokeStyle, lineWidth, font, textAlign, transform, clipped });
  }

  restore() {
    Object.assign(this, this.kept.pop());
  }

  translate(x, y) {
    this.transform += ` translate(${x} ${y})`;
  }

  rotate(angle) {
    this.transform += ` rotate(${(180 * angle) / Math.PI})`;
  }

  setLineDash(dashes) {
    this.dashes = dashes;
  }

  beginPath() {
    this.way = "";
  }

  moveTo(x, y) {
    this.way += `M${x.toFixed(1)} ${y.toFixed(1)}`;
  }

  lineTo(x, y) {
    this.way += `L${x.toFixed(1)} ${y.toFixed(1)}`;
  }

  rect(x, y, w, h) {
    this.way += `M${x} ${y}h${w}v${h}h${-w}z`;
  }

  /** A whole circle. */
  arc(x, y, radius) {
    const turn = `${radius} ${radius} 0 1 0`;
    this.way += `M${(x - radius).toFixed(1)} ${y.toFixed(1)}a${turn} ${2 * radius} 0a${turn} ${-2 * radius} 0`;
  }

  clip() {
    this.clipped = `c${(this.clips += 1)}`;
    this.parts.push(`<clipPath id="${this.clipped}"><path d="${this.way}"${this.moved()}/></clipPath>`);
  }

  fill() {
    this.add("path", `d="${this.way}" fill="${this.fillStyle}"`);
  }

  stroke() {
    this.add("path", `d="${this.way}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" stroke-dasharray="${this.dashes.join(" ")}"`);
  }

  fillRect(x, y, w, h) {
    this.add("rect", `x="${x}" y="${y}" width="${w}" height="${h}" fill="${this.fillStyle}"`);
  }

  strokeRect(x, y, w, h) {
    this.add("rect", `x="${x}" y="${y}" width="${w}" height="${h}" fill="none" stroke="${this.strokeStyle}"`);
  }

  fillText(text, x, y) {
    this.write(text, x, y, `fill="${this.fillStyle}"`);
  }

  strokeText(text, x, y) {
    this.write(text, x, y, `fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"`);
  }

  drawImage(canvas, x, y, w, h) {
    this.add("image", `x="${x}" y="${y}" width="${w}" height="${h}" preserveAspectRatio="none" href="${canvas.toDataURL()}"`);
  }

  write(text, x, y, look) {
    const anchor = { left: "start", center: "middle", right: "end" }[this.textAlign];
    this.add("text", `x="${x}" y="${y}" text-anchor="${anchor}" style="font: ${this.font}" ${look}`, escaped(text));
  }

  add(element, attributes, content = "") {
    const part = `<${element} ${attributes}${this.moved()}>${content}</${element}>`;
    // By a group, which is not moved: the clip was, when it was made.
    this.parts.push(this.clipped ? `<g clip-path="url(#${this.clipped})">${part}</g>` : part);
  }

  moved() {
    return this.transform ? ` transform="${this.transform.trim()}"` : "";
  }

  /** The picture. */
  svg() {
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${this.width}" height="${this.height}" viewBox="0 0 ${this.width} ${this.height}">` +
      `${this.parts.join("\n")}</svg>\n`;
  }
}

/** A picture as it is seen, between its title and its colour bar: `paint` draws it, so wide and high. */
function pictured(title, bar, [width, height], paint) {
  const titles = wrapped(title, (width - 16) / 8);
  const above = 8 + 18 * titles.length;
  const paper = new Paper(width, above + height + (bar ? 48 : 0));
  paper.fillStyle = styled("--paper");
  paper.fillRect(0, 0, paper.width, paper.height);
  paper.fillStyle = styled("--ink");
  paper.font = "bold 14px sans-serif";
  titles.forEach((line, k) => paper.fillText(line, 8, 17 + 18 * k));
  paper.font = "11px sans-serif";
  paper.save();
  paper.translate(0, above);
  paint(paper);
  paper.restore();
  if (bar) {
    paper.translate(0, above + height);
    bar.paint(paper, 66, Math.min(460, width - 90));
  }
  return paper.svg();
}
