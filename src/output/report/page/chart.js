"use strict";
// Charts: uPlot with zoom, read-off, keyboard and export. Each is drawn when it comes into sight, all of them before the page is
// ready, so that they are there when it is printed or captured.

const charts = [];
const watcher = new IntersectionObserver((entries) => {
  for (const entry of entries) if ((entry.target.chart.seen = entry.isIntersecting)) entry.target.chart.draw();
}, { rootMargin: "300px" });

/** Draw what has not been drawn yet and has room, a little at a time so that the page can be used meanwhile. */
async function drawAll() {
  let begun = performance.now();
  for (const chart of charts) {
    chart.draw();
    if (performance.now() - begun < 50) continue;
    await new Promise((done) => setTimeout(done));
    begun = performance.now();
  }
}

/** A line, or a point, as a curve is drawn. */
function sample({ colour, dash, points }) {
  const shape = points ? `<circle cx="14" cy="5" r="3.5" fill="${colour}"/>`
    : `<line x1="0" y1="5" x2="28" y2="5" stroke="${colour}" stroke-width="2" stroke-dasharray="${(dash || []).join(" ")}"/>`;
  const made = el("span", { class: "sample" });
  made.innerHTML = `<svg width="28" height="10" aria-hidden="true">${shape}</svg>`;
  return made;
}

/** Rows of several curves under one ascending x: `undefined` where a curve has no row, `null` where it has no number. */
function aligned(series, shown) {
  const clean = (y) => Array.from(y, (value) => (shown(value) ? value : null));
  const groups = new Map();
  series.forEach((one, k) => {
    if (!groups.has(one.x)) groups.set(one.x, []);
    groups.get(one.x).push(k);
  });
  const tables = [...groups].map(([x, members]) => [Array.from(x), ...members.map((k) => clean(series[k].y))]);
  const order = [...groups.values()].flat();
  const all = tables.length === 1 ? tables[0] : uPlot.join(tables);
  const data = [all[0]];
  order.forEach((k, i) => (data[k + 1] = all[i + 1]));
  return data;
}

/** Curves that are no functions of x, one behind the other. */
function consecutive(series, shown) {
  const x = series.flatMap((one) => Array.from(one.x));
  const data = [x];
  let start = 0;
  for (const one of series) {
    const y = new Array(x.length).fill(undefined);
    one.y.forEach((value, k) => (y[start + k] = shown(value) && Number.isFinite(one.x[k]) ? value : null));
    data.push(y);
    start += one.x.length;
  }
  return data;
}

/** Draws a curve through its own points in their own order. */
const ownWay = (u, k) => {
  const stroke = new Path2D();
  let down = false;
  for (let i = 0; i < u.data[0].length; i++) {
    const y = u.data[k][i];
    if (y === undefined) continue;
    if (y === null) down = false;
    else {
      const [px, py] = [u.valToPos(u.data[0][i], "x", true), u.valToPos(y, "y", true)];
      if (down) stroke.lineTo(px, py);
      else stroke.moveTo(px, py);
      down = true;
    }
  }
  return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 0 };
};

class Chart {
  /** series: {name, x, y, colour, dash, points, unlisted: not in the legend}; x, y: {label, log, include}; path: curves are no functions of x;
   * time: x is time. */
  constructor({ title, x, y, series, path = false, time = false, click = null, height = 250 }) {
    Object.assign(this, { title, x, y, series, path, time, click, height, plot: null });
    this.host = el("div", { class: "plot", tabindex: 0, role: "img", "aria-label": `${title}: ${y.label} over ${x.label}` });
    this.host.style.minHeight = `${height}px`;
    this.host.addEventListener("keydown", (event) => this.key(event));
    const tools = el("span", { class: "tools" },
      button("log", "Logarithmic, as far as it is positive, or linear", () => this.turn()),
      button("⤢", "Show all again", () => this.reset()),
      button("SVG", "Save this chart as SVG", () => this.draw().plot && saveSvg(this.title, svg(this))),
      button("PNG", "Save this chart as PNG", () => this.draw().plot && savePng(this.title, svg(this))),
      button("CSV", "Save its data as CSV", () => this.series.length && save(fileName(this.title, "csv"), this.csv(), "text/csv")));
    this.caption = el("span", {}, title);
    this.element = el("figure", { class: "chart" }, el("figcaption", {}, this.caption, tools), this.host);
    this.host.chart = this;
    watcher.observe(this.host);
    charts.push(this);
  }

  width() {
    return Math.max(240, Math.floor(this.host.clientWidth));
  }

  /** Draw it, if it is not yet, and there is something to draw. */
  draw() {
    if (!this.plot && this.series.length && this.host.clientWidth) this.plot = new uPlot(this.options(), this.data(), this.host);
    return this;
  }

  /** Draw it again: in other colours, with other data. */
  redraw() {
    if (!this.plot) return;
    this.plot.destroy();
    this.plot = null;
    this.draw();
  }

  /** Other curves; the axis stays logarithmic, or linear. */
  set(series, title, y, x = this.x) {
    Object.assign(this, { series, title, x, y: { ...y, log: this.y.log } });
    this.caption.textContent = title;
    if (this.plot) this.redraw();
    else if (this.seen) this.draw();
  }

  data() {
    const shown = (value) => Number.isFinite(value) && !(this.y.log && value <= 0);
    return (this.path ? consecutive : aligned)(this.series, shown);
  }

  /** From a linear axis to a logarithmic one, which shows what is positive, and back. */
  turn() {
    this.y = { ...this.y, log: !this.y.log };
    this.redraw();
  }

  csv() {
    const names = [this.x.label, ...this.series.map((one) => one.name)];
    const [x, ...columns] = this.data();
    return csv(names, [this.x.size > 1 ? x.map((value) => value / this.x.size) : x, ...columns]);
  }

  options() {
    const [ink, grid] = [styled("--ink"), styled("--grid")];
    const line = (of) => ({ stroke: grid, width: 1, ...(of.log && { filter: (u, splits) => powers(splits) }) });
    // Numbers have as much room as the longest needs.
    const besides = (u, texts) => Math.max(62, 30 + 6.5 * Math.max(0, ...(texts || []).map((text) => text.length)));
    // A label that is longer than its axis is written smaller.
    const axis = (of, size, room) => ({
      stroke: ink, grid: line(of), ticks: line(of), label: of.label, size, labelSize: 20,
      font: "11px sans-serif", labelFont: `${Math.min(12, (12 * room) / (7 * of.label.length)).toFixed(1)}px sans-serif`,
      values: (u, splits) => (of.log ? splits.map((value) => (value == null ? "" : told(value, 2))) : tickTexts(splits.map((value) => value / (of.size || 1)))),
      // Ticks are round in the unit that is shown.
      ...(of.size > 1 && { splits: (u, _, low, high) => ticks(low / of.size, high / of.size, room / 80).map((value) => value * of.size) }),
    });
    const series = this.series.map((one) => ({
      label: one.name, stroke: one.colour, width: one.points ? 0 : 1.6, dash: one.dash, spanGaps: false,
      paths: this.path ? ownWay : undefined,
      points: one.points ? { show: true, size: 7, fill: one.colour, stroke: one.colour } : { show: this.series[0].x.length < 30 && !one.plain, size: 4 },
      value: (u, value) => (value == null ? "" : told(value, 6)),
    }));
    const include = this.y.include || [];
    return {
      width: this.width(), height: this.height, padding: [8, 24, 0, 0],
      legend: { live: true },
      scales: {
        x: { time: false, ...(this.x.log && { distr: 3 }), ...(this.x.reverse && { dir: -1 }), ...(this.path && { range: (u, low, high) => this.across(u, low, high) }) },
        y: {
          ...(this.y.log && { distr: 3 }),
          ...((this.path || !this.y.log) && { range: (u, low, high) => this.upwards(low, high, include) }),
        },
      },
      axes: [axis(this.x, 42, this.width() - 86), axis(this.y, besides, this.height - 50)],
      series: [{ label: this.x.label, value: (u, value) => (value == null ? "" : told(value / (this.x.size || 1), 8)) }, ...series],
      cursor: {
        drag: { x: true, y: true, uni: 30 }, focus: { prox: 24 },
        ...(this.time && { sync: { key: "time", setSeries: false, scales: ["x", null] } }),
        ...(this.path && { dataIdx: (u, k) => this.near(u, k) }),
      },
      hooks: {
        draw: [(u) => this.time && marked(u)],
        // Where nothing is pointed at the legend has no values.
        setCursor: [(u) => u.root.classList.toggle("pointed", u.cursor.left >= 0)],
        ready: [(u) => {
          u.over.addEventListener("click", () => this.clicked(u));
          const rows = u.root.querySelectorAll(".u-legend .u-series");
          this.series.forEach((one, k) => {
            rows[k + 1].querySelector(".u-marker")?.replaceWith(sample(one));
            rows[k + 1].hidden = Boolean(one.unlisted);
          });
        }],
      },
    };
  }

  /** A click without a drag. */
  clicked(u) {
    if (u.cursor.left == null || u.cursor.left < 0 || u.select.width > 0) return;
    const x = u.posToVal(u.cursor.left, "x");
    if (this.click) this.click(x);
    else if (this.time) now.set(x, this);
  }

  /** What is seen along x of curves that are no functions of it: all, unless it is told. */
  across(u, low, high) {
    // uPlot takes the first and the last for the least and the largest; the first is no number where a curve begins with a break.
    const [first, last] = [u.data[0][0], u.data[0][u.data[0].length - 1]];
    const isTold = ![[first, last], [last, first]].some(([a, b]) => Object.is(low, a) && Object.is(high, b));
    if (isTold) return [low, high];
    const { log, include } = this.x;
    if (log) return decades(...bounds(this.series.flatMap((one) => [...bounds(one.x.filter((value) => value > 0))])));
    return this.reach("x", include);
  }

  /** What is seen of curves along an axis: with what bounds them, unless the curves were a speck then. */
  reach(axis, include = []) {
    const of = (some) => some.flatMap((one) => bounds(one[axis]));
    const [own, all] = [this.series.filter((one) => !one.plain), [...of(this.series), ...include]];
    const shares = ["x", "y"].map((name) => {
      const [low, high] = bounds(own.flatMap((one) => bounds(one[name])));
      const [least, most] = bounds([...this.series.flatMap((one) => bounds(one[name])), ...(this[name].include || [])]);
      return (high - low) / (most - least || 1);
    });
    return padded(...bounds(own.length && Math.max(...shares) < SPECK ? of(own) : all));
  }

  /** What is seen along y; uPlot takes the rows between two of ascending x, which such curves do not have. */
  upwards(low, high, include) {
    const { log } = this.y;
    if (this.path && !log) return this.reach("y", include);
    if (this.path) [low, high] = bounds(this.series.flatMap((one) => [...bounds(one.y.filter((value) => value > 0))]));
    if (log) return decades(low, high);
    return padded(Math.min(low, ...include), Math.max(high, ...include));
  }

  /** The point of a curve that is nearest to the cursor. */
  near(u, k) {
    const { left, top } = u.cursor;
    let [best, least] = [null, Infinity];
    for (let i = 0; k > 0 && i < u.data[0].length; i++) {
      if (u.data[k][i] == null) continue;
      const away = Math.hypot(u.valToPos(u.data[0][i], "x") - left, u.valToPos(u.data[k][i], "y") - top);
      if (away < least) [best, least] = [i, away];
    }
    return best;
  }

  reset() {
    if (this.plot) this.plot.setData(this.plot.data, true);
  }

  /** Zoom by a factor about the cursor, or the middle. */
  zoom(factor) {
    const { min, max } = this.plot.scales.x;
    const at = this.plot.cursor.left >= 0 ? this.plot.posToVal(this.plot.cursor.left, "x") : 0.5 * (min + max);
    this.plot.setScale("x", { min: at + (min - at) * factor, max: at + (max - at) * factor });
  }

  key(event) {
    const u = this.plot;
    if (!u || event.ctrlKey || event.metaKey || event.altKey) return;
    const xs = u.data[0];
    const from = u.cursor.idx ?? nearest(xs, 0.5 * (u.scales.x.min + u.scales.x.max));
    const move = (idx) => {
      const i = Math.max(0, Math.min(xs.length - 1, idx));
      const left = u.valToPos(xs[i], "x");
      const y = u.data.slice(1).map((column) => column[i]).find((value) => value != null);
      u.setCursor({ left, top: y == null ? 10 : u.valToPos(y, "y") });
    };
    const keys = {
      ArrowLeft: () => move(from - (event.shiftKey ? 10 : 1)), ArrowRight: () => move(from + (event.shiftKey ? 10 : 1)),
      Home: () => move(0), End: () => move(xs.length - 1),
      "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2), 0: () => this.reset(), Escape: () => this.reset(),
      Enter: () => this.clicked(u),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  }
}

/** Over many decades powers of ten alone have lines. */
function powers(splits) {
  const isPower = (value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-6;
  return splits.filter(isPower).length > 4 ? splits.map((value) => (isPower(value) ? value : null)) : splits;
}

/** Curves that fill less of a chart are shown without what bounds them. */
const SPECK = 0.15;

/** Whole decades about two numbers. */
const decades = (low, high) => (low > 0 ? [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high * (1 + 1e-9)))] : [0.1, 1]);

/** A little more than what is between two numbers. */
function padded(low, high) {
  if (!(low <= high)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  const room = high - low > 1e-9 * size ? 0.05 * (high - low) : 0.1 * size || 1;
  return [low === 0 ? 0 : low - room, high === 0 ? 0 : high + room];
}

/** The time that is looked at, as a line. */
function marked(u) {
  if (now.time == null) return;
  const x = u.valToPos(now.time, "x", true);
  const { left, top, width, height } = u.bbox;
  if (x < left || x > left + width) return;
  const { ctx } = u;
  ctx.save();
  ctx.strokeStyle = styled("--mark");
  ctx.lineWidth = uPlot.pxRatio;
  ctx.setLineDash([4, 3]);
  ctx.beginPath();
  ctx.moveTo(x, top);
  ctx.lineTo(x, top + height);
  ctx.stroke();
  ctx.restore();
}

now.hear("charts", () => {
  for (const chart of charts) if (chart.time && chart.plot) chart.plot.redraw(false);
});

let resizing = null;
addEventListener("resize", () => {
  clearTimeout(resizing);
  resizing = setTimeout(() => sized((chart) => chart.width()), 100);
});

function sized(width) {
  for (const chart of charts) if (chart.plot) chart.plot.setSize({ width: width(chart), height: chart.height });
}

/** Width of a chart of which two stand beside each other on a sheet of A4 [px]. */
const ON_PAPER = 340;

addEventListener("beforeprint", () => {
  charts.forEach((chart) => chart.draw());
  sized(() => ON_PAPER);
});
addEventListener("afterprint", () => sized((chart) => chart.width()));
