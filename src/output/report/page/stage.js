"use strict";
// The picture of the deformed bodies: what is seen of them, tractions, values under the pointer.

/** What is drawn of the bodies; `Bodies` chooses what. */
class BodiesPicture {
  contactFrame(time) {
    const { frames } = this.contact;
    const frame = frames[nearest(frames.map((one) => one.time), time)];
    return frame.time === time ? frame : null;
  }

  range() {
    const { field, options } = this;
    const frames = options.range === "frame" ? [this.solid.frames[this.frame]] : this.solid.frames;
    const [low, high] = options.range === "fixed" ? options.fixed : span({ frames }, field, this, options.range === "most");
    if (options.map !== "blue–red" || options.range === "fixed") return [low, high];
    const size = Math.max(Math.abs(low), Math.abs(high));
    return [-size, size];
  }

  draw() {
    if (!this.solid || this.frame == null) return;
    const range = this.range();
    const [w, h] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const { zoom, centre } = this.camera;
    const [sx, sy] = [(2 * zoom) / w, (2 * zoom) / h];
    const view = [sx, sy, -centre[0] * sx, -centre[1] * sy];
    const ink = document.documentElement.dataset.theme === "dark" || styled("--paper") !== "#fff" ? [0.85, 0.87, 0.9, 1] : [0.1, 0.1, 0.12, 1];
    this.scene.draw({ view, scale: this.scale, range, edges: this.options.edges, ink });
    const context = this.over.getContext("2d");
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.clearRect(0, 0, w, h);
    this.decorate(context, w, h);
    const texts = rangeTexts(range, span(this.solid, this.field, this));
    this.bar.show(this.solid.cells ? withUnit(this.field.label, this.field.unit) : "", texts, this.options.map);
    this.bar.element.hidden = !this.solid.cells;
    this.drawn = performance.now();
  }

  /** Where a point is on the canvas [px]. */
  at(x, y, w, h) {
    const { zoom, centre } = this.camera;
    return [0.5 * w + (x - centre[0]) * zoom, 0.5 * h - (y - centre[1]) * zoom];
  }

  /** Tractions, point masses, a scale, and by how much displacements are enlarged. */
  decorate(context, w, h) {
    context.font = "12px sans-serif";
    if (!this.solid.cells) this.masses(context, w, h);
    if (this.bars) this.bars.draw(context, this, w, h);
    if (this.options.tractions && this.contact && this.contact.largest > 0) this.tractions(context, w, h);
    context.fillStyle = context.strokeStyle = styled("--ink");
    const length = roundBelow(120 / this.camera.zoom);
    const [x, y] = [12, h - 14];
    context.fillRect(x, y, length * this.camera.zoom, 3);
    context.fillText(`${told(length, 3)} ${unitOf("length")}`, x, y - 5);
    if (this.scale !== 1) context.fillText(`displacement × ${told(this.scale, 3)}`, x, 18);
  }

  masses(context, w, h) {
    context.fillStyle = curveColour(0);
    for (let k = 0; k < this.solid.points; k++) {
      const place = [0, 1].map((i) => this.places[2 * k + i] + this.scale * this.moved[2 * k + i]);
      const [x, y] = this.at(...place, w, h);
      context.beginPath();
      context.arc(x, y, 9, 0, 2 * Math.PI);
      context.fill();
    }
  }

  /** Forces per area on the slave, p n − q s, as a comb on the surface. */
  tractions(context, w, h) {
    const { contact } = this;
    const frame = this.contactFrame(this.solid.frames[this.frame].time);
    if (!frame || !frame.displacement || !frame.fields.pressure) return;
    const [moved, pressure] = [peek(frame.displacement), peek(frame.fields.pressure.components[0].chunk)];
    const traction = frame.fields.traction && peek(frame.fields.traction.components[0].chunk);
    if (!moved || !pressure) return;
    const place = (scale) => (k) => this.at(...[0, 1].map((i) => contact.places[2 * k + i] + contact.shift[i] + scale * moved[2 * k + i]), w, h);
    const length = 60 / contact.largest;
    context.strokeStyle = "#d62800";
    context.lineWidth = 1.2;
    for (const line of contact.lines) {
      if (line.length < 2) continue;
      const at = Array.from(line, place(this.scale));
      // Directions are those of the surface as it is, not as it is enlarged.
      const surface = Array.from(line, place(1));
      const tips = at.map(([x, y], i) => {
        const [a, b] = [surface[Math.max(0, i - 1)], surface[Math.min(at.length - 1, i + 1)]];
        const size = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
        // On the canvas y points down: s along the line, n to its left.
        const [s, n] = [[(b[0] - a[0]) / size, (b[1] - a[1]) / size], [(b[1] - a[1]) / size, -(b[0] - a[0]) / size]];
        const [p, q] = [pressure[line[i]] || 0, traction ? traction[line[i]] || 0 : 0];
        return [x + length * (p * n[0] - q * s[0]), y + length * (p * n[1] - q * s[1])];
      });
      context.beginPath();
      // Teeth that stand apart, and a line along their tips where there is contact.
      let last = [-Infinity, 0];
      let closed = false;
      at.forEach((from, i) => {
        const acts = pressure[line[i]] !== 0;
        if (acts && Math.hypot(from[0] - last[0], from[1] - last[1]) >= 5) {
          context.moveTo(...from);
          context.lineTo(...tips[i]);
          last = from;
        }
        if (acts && closed) {
          context.moveTo(...tips[i - 1]);
          context.lineTo(...tips[i]);
        }
        closed = acts;
      });
      context.stroke();
    }
  }

  resize() {
    if (!this.canvas) return;
    const [w, h] = [this.stage.clientWidth, this.stage.clientHeight];
    // What is seen from side to side stays the same.
    if (this.camera && this.width > 0) this.camera.zoom *= w / this.width;
    this.width = w;
    this.ratio = Math.min(devicePixelRatio || 1, this.solid.cells > 30000 ? 1 : 2);
    for (const canvas of [this.canvas, this.over]) [canvas.width, canvas.height] = [w * this.ratio, h * this.ratio];
    this.draw();
  }

  /** Show all of the bodies, in the first and the last frame. */
  async fit() {
    const { frames } = this.solid;
    const moves = await Promise.all([frames[0], frames[frames.length - 1]].map((frame) => frame.displacement && unpack(frame.displacement)));
    const box = [0, 1].map((i) => {
      const all = [];
      for (let k = i; k < this.places.length; k += 2) for (const moved of moves) all.push(this.places[k] + (moved ? this.scale * moved[k] : 0));
      return bounds(all);
    });
    const sizes = box.map(([low, high]) => high - low);
    const least = Math.max(...sizes, this.solid.largest) || 1;
    const [w, h] = [this.stage.clientWidth, this.stage.clientHeight];
    const zoom = 0.9 * Math.min(w / Math.max(sizes[0], 1e-3 * least), h / Math.max(sizes[1], 1e-3 * least));
    this.camera = { zoom, centre: box.map(([low, high]) => 0.5 * (low + high)) };
  }

  zoom(factor, x = 0.5 * this.stage.clientWidth, y = 0.5 * this.stage.clientHeight) {
    const { zoom, centre } = this.camera;
    const away = [x - 0.5 * this.stage.clientWidth, 0.5 * this.stage.clientHeight - y];
    this.camera = { zoom: zoom * factor, centre: centre.map((c, i) => c + (away[i] / zoom) * (1 - 1 / factor)) };
    this.draw();
  }

  move(dx, dy) {
    const { zoom, centre } = this.camera;
    this.camera.centre = [centre[0] - dx / zoom, centre[1] + dy / zoom];
    this.draw();
  }

  /** The values at the node under the pointer. */
  tell(px, py) {
    if (!this.moved) return;
    const { places, moved, scale, solid } = this;
    const [w, h] = [this.stage.clientWidth, this.stage.clientHeight];
    let [best, least] = [-1, 15];
    for (let k = 0; k < solid.points; k++) {
      const [x, y] = this.at(places[2 * k] + scale * moved[2 * k], places[2 * k + 1] + scale * moved[2 * k + 1], w, h);
      const away = Math.hypot(x - px, y - py);
      if (away < least) [best, least] = [k, away];
    }
    const at = [0, 1].map((i) => told(places[2 * best + i] + solid.origin[i]));
    const u = [0, 1].map((i) => told(moved[2 * best + i]));
    const value = isNumber(this.values[best]) ? told(this.values[best]) : "no number";
    this.probe.textContent = best < 0 ? "" :
      `node ${best} at (${at.join(", ")}) ${unitOf("length")}: ${this.field.label} ${value} ${this.field.unit}, displacement (${u.join(", ")}) ${unitOf("length")}`;
  }

  /** The picture as SVG; the bodies in it are pixels, as the graphics card has drawn them. */
  svg() {
    const size = [this.stage.clientWidth, this.stage.clientHeight];
    this.draw();
    return pictured(`${this.title()}, ${this.clock.value}`, this.solid.cells ? this.bar : null, size, (paper) => {
      paper.drawImage(this.canvas, 0, 0, ...size);
      this.decorate(paper, ...size);
    });
  }

  /** What is in the picture. */
  title() {
    return several ? `${this.run.name}: ${this.field.label}` : this.field.label;
  }

  /** Places, displacements and values of all nodes of the frame. */
  csv() {
    const { places, moved, solid, values } = this;
    const of = (array, i, shift = 0) => Float64Array.from({ length: solid.points }, (_, k) => array[2 * k + i] + shift);
    const both = (array, shift) => [0, 1].map((i) => of(array, i, shift?.[i]));
    const shown = Array.from(values, (value) => (isNumber(value) ? value : NaN));
    const names = ["x", "y", "displacement x", "displacement y"].map((name) => withUnit(name, unitOf("length")));
    return csv([...names, withUnit(this.field.label, this.field.unit)], [...both(places, solid.origin), ...both(moved), shown]);
  }
}
