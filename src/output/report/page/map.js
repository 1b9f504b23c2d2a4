"use strict";
// The picture of an interface over place and time: colours, axes, fronts, and how far waves get.

/** Decades that a logarithmic scale shows. */
const DECADES = 6;

/** What is drawn of an interface; `Interface` chooses what. */
class InterfacePicture {
  /** Middle of the places where something is at the end of the run. */
  busiest() {
    const [points, row] = [this.places.length, this.times.length - 1];
    const busy = [...this.places.keys()].filter((k) => this.values[row * points + k]);
    return busy.length ? busy[busy.length >> 1] : points >> 1;
  }

  /** The whole of place and time. */
  all() {
    const [s0, s1] = bounds(this.places);
    const rows = this.times.length;
    const t = this.settings.axis === "row" ? [0, rows] : [this.start(0), this.times[rows - 1]];
    this.window = { s: s1 > s0 ? [s0, s1] : [s0 - 1, s0 + 1], t: t[1] > t[0] ? t : [t[0], t[0] + 1] };
  }

  /** Begin of the time that a row stands for. */
  start(row) {
    const { times } = this;
    if (row > 0) return times[row - 1];
    return times.length > 1 ? Math.max(Math.min(0, times[0]), 2 * times[0] - times[1]) : 0;
  }

  /** What is upwards, at the end of a row. */
  up(row) {
    return this.settings.axis === "row" ? row + 1 : this.times[row];
  }

  /** The row at a height. */
  rowAt(up) {
    if (this.settings.axis === "row") return Math.max(0, Math.min(this.times.length - 1, Math.floor(up)));
    let [low, high] = [0, this.times.length - 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] < up) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Range of the colours, and how a value is placed in it. */
  scale() {
    let [low, high] = this.settings.most && !this.settings.log ? this.mostly : this.quantity.range;
    if (low === high) [low, high] = this.quantity.range;
    if (this.settings.log) {
      const top = Math.log10(Math.max(Math.abs(low), Math.abs(high)) || 1);
      return { low: top - DECADES, high: top, of: (value) => (Number.isNaN(value) ? NaN : (Math.log10(Math.abs(value)) - top + DECADES) / DECADES) };
    }
    if (this.settings.colours === "blue–red") [low, high] = [-1, 1].map((sign) => sign * Math.max(Math.abs(low), Math.abs(high)));
    return { low, high, of: (value) => (high > low ? (value - low) / (high - low) : 0.5) };
  }

  draw() {
    const [w, h] = [this.view.clientWidth, this.view.clientHeight];
    if (!this.values || !w || this.map.points < 2) return;
    const ratio = Math.min(2, devicePixelRatio || 1);
    [this.canvas.width, this.canvas.height] = [w * ratio, h * ratio];
    const context = this.canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.fillStyle = styled("--paper");
    context.fillRect(0, 0, w, h);
    this.box = { x: 66, y: 8, w: w - 80, h: h - 54 };
    this.paint(context, ratio);
    const { low, high } = this.scale();
    const powers = [0, 1, 2, 3].map((third) => told(10 ** (low + (third / 3) * (high - low)), 2));
    if (this.settings.log) powers[0] = `≤ ${powers[0]}`;
    const texts = this.settings.log ? powers : rangeTexts([low, high], this.quantity.range);
    const size = this.settings.log ? `|${spoken(this.quantity.name)}|` : spoken(this.quantity.name);
    this.bar.show(withUnit(size, fieldUnit(this.quantity.name)), texts, this.settings.colours);
  }

  /** The picture itself: colours, axes, fronts, and what is chosen. */
  paint(context, ratio) {
    const { x, y, w, h } = this.box;
    context.drawImage(this.image(ratio), x, y, w, h);
    this.axes(context);
    context.save();
    context.beginPath();
    context.rect(x, y, w, h);
    context.clip();
    if (this.settings.fronts && this.fronts) this.passages(context);
    this.cross(context);
    context.restore();
  }

  /** The picture as SVG. */
  svg() {
    return pictured(this.title(), this.bar, [this.view.clientWidth, this.view.clientHeight], (context) => this.paint(context, 1));
  }

  /** What is in the picture. */
  title() {
    return `${several ? `${this.run.name}: ` : ""}${spoken(this.quantity.name)} of ${this.map.contact}`;
  }

  /** Every pixel: what happened last in its time, or the fastest slip. */
  image(ratio) {
    const { box, places, values, window } = this;
    const points = places.length;
    const [width, height] = [Math.max(1, Math.round(box.w * ratio)), Math.max(1, Math.round(box.h * ratio))];
    const picture = new ImageData(width, height);
    const lut = lutOf(this.settings.colours);
    const scale = this.scale();
    const fastest = this.quantity.name.endsWith("rate");
    const columns = Array.from({ length: width }, (_, i) => nearest(places, window.s[0] + ((i + 0.5) / width) * (window.s[1] - window.s[0])));
    const line = new Float64Array(points);
    const upAt = (j) => window.t[1] - (j / height) * (window.t[1] - window.t[0]);
    for (let j = 0; j < height; j++) {
      const [first, last] = [this.rowAt(upAt(j + 1) + 1e-9 * (window.t[1] - window.t[0])), this.rowAt(upAt(j))];
      for (let k = 0; k < points; k++) {
        let value = values[last * points + k];
        for (let row = first; fastest && row < last; row++) {
          if (Math.abs(values[row * points + k]) > Math.abs(value)) value = values[row * points + k];
        }
        line[k] = value;
      }
      for (let i = 0; i < width; i++) {
        const level = scale.of(line[columns[i]]);
        const to = 4 * (j * width + i);
        const from = Number.isNaN(level) ? -1 : 4 * Math.max(0, Math.min(255, Math.round(255 * level)));
        for (let c = 0; c < 3; c++) picture.data[to + c] = from < 0 ? BLANK[c] : lut[from + c];
        picture.data[to + 3] = 255;
      }
    }
    const canvas = el("canvas", { width, height });
    canvas.getContext("2d").putImageData(picture, 0, 0);
    return canvas;
  }

  /** Where a place and a height are [px]. */
  at(s, up) {
    const { box, window } = this;
    return [box.x + (box.w * (s - window.s[0])) / (window.s[1] - window.s[0]), box.y + box.h * (1 - (up - window.t[0]) / (window.t[1] - window.t[0]))];
  }

  axes(context) {
    const { box, window } = this;
    context.strokeStyle = context.fillStyle = styled("--ink");
    context.font = "11px sans-serif";
    context.strokeRect(box.x, box.y, box.w, box.h);
    const places = ticks(...window.s, box.w / 80);
    context.textAlign = "center";
    tickTexts(places).forEach((text, k) => {
      const [x] = this.at(places[k], 0);
      context.fillRect(x, box.y + box.h, 1, 4);
      context.fillText(text, x, box.y + box.h + 16);
    });
    // Of times that differ only in their last digits the difference is told.
    const [low, high] = window.t;
    const zero = this.settings.axis === "time" && high - low < 1e-3 * Math.abs(low) ? Number((low / clock.size).toPrecision(9)) * clock.size : 0;
    const byTime = this.settings.axis === "time";
    // Times have the unit of the run, or, close up, the one that suits what is seen.
    const unit = !byTime ? "" : zero ? spanned(high - low)[1] : clock.unit;
    const size = !byTime ? 1 : zero ? lengthOf(unit) : clock.size;
    const heights = ticks((low - zero) / size, (high - zero) / size, box.h / 44).map((value) => value * size);
    context.textAlign = "right";
    tickTexts(heights.map((value) => value / size)).forEach((text, k) => {
      const [, y] = this.at(0, heights[k] + zero);
      context.fillRect(box.x - 4, y, 4, 1);
      context.fillText(text, box.x - 7, y + 4);
    });
    context.textAlign = "center";
    context.font = "12px sans-serif";
    context.fillText(withUnit("position along the slave", unitOf("length")), box.x + 0.5 * box.w, box.y + box.h + 36);
    const what = byTime ? withUnit(zero ? `time − ${clock.size > 1 ? timed(zero, 9) : told(zero, 9)}` : "time", unit) : "output";
    context.save();
    context.translate(13, box.y + 0.5 * box.h);
    context.rotate(-0.5 * Math.PI);
    context.fillText(what, 0, 0);
    context.restore();
  }

  /** When fronts passed. */
  passages(context) {
    const [contact, point, arrival] = ["contact", "point", "arrival"].map((name) => this.fronts.get(name));
    if (!contact || !point || !arrival) return;
    // Over the whole run they would hide what they are about.
    const { t } = this.window;
    if (this.settings.axis === "time" && this.longest < 0.05 * (t[1] - t[0])) return;
    context.fillStyle = "#ffffff";
    context.strokeStyle = "#00000090";
    for (let row = 0; row < this.fronts.rows; row++) {
      if (contact[row] !== this.map.contact || !(point[row] < this.places.length)) continue;
      const time = arrival[row];
      const [x, y] = this.at(this.places[point[row]], this.settings.axis === "row" ? this.rowAt(time) + 0.5 : time);
      if (y < this.box.y || y > this.box.y + this.box.h) continue;
      context.beginPath();
      context.arc(x, y, 1.8, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
    }
  }

  /** The chosen time and place, and how far waves get from there. */
  cross(context) {
    const { row, point } = this.chosen;
    const [x, y] = this.at(this.places[point], this.up(row) - (this.settings.axis === "row" ? 0.5 : 0));
    const lines = (style, dashes, ...ways) => {
      context.setLineDash(dashes);
      for (const [colour, width] of [["#000000a0", 3], [style, 1.3]]) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.beginPath();
        for (const [a, b] of ways) {
          context.moveTo(...a);
          context.lineTo(...b);
        }
        context.stroke();
      }
      context.setLineDash([]);
    };
    lines("#ffffff", [], [[0, y], [9999, y]], [[x, 0], [x, 9999]]);
    const speeds = (this.run.summary.wave_speeds || []).filter((speed) => speed > 0);
    if (!this.settings.waves || this.settings.axis === "row" || speeds.length < 3) return;
    const { s, t } = this.window;
    // Where waves cross everything within a pixel or two they say nothing.
    if ((s[1] - s[0]) / speeds[0] < 0.03 * (t[1] - t[0])) return;
    context.font = "11px sans-serif";
    context.textAlign = "left";
    [["c_R", []], ["c_s", [6, 3]], ["c_p", [2, 3]]].forEach(([name, dashes], k) => {
      // To what comes after, or at the top of the picture from what was before.
      const later = this.times[row] < t[0] + 0.7 * (t[1] - t[0]) ? 1 : -1;
      const far = Math.min(0.3 * (t[1] - t[0]), (0.3 * (s[1] - s[0])) / speeds[k]);
      const ends = [-1, 1].map((sign) => this.at(this.places[point] + sign * speeds[k] * far, this.times[row] + later * far));
      lines("#ffffff", dashes, ...ends.map((end) => [[x, y], end]));
      context.strokeStyle = "#000000";
      context.fillStyle = "#ffffff";
      context.lineWidth = 3;
      const [ex, ey] = [ends[1][0] + 3, ends[1][1] + 4 + (k === 0 ? -9 : 0)];
      context.strokeText(name, ex, ey);
      context.fillText(name, ex, ey);
    });
  }

  /** Nothing is shown beyond what there is. */
  limit() {
    const { window } = this;
    this.all();
    const whole = this.window;
    for (const axis of ["s", "t"]) {
      const [low, high] = [Math.max(whole[axis][0], window[axis][0]), Math.min(whole[axis][1], window[axis][1])];
      if (high > low) whole[axis] = [low, high];
    }
  }
}
