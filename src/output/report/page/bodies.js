"use strict";
// Deformed bodies over time: slider, field, scale of displacement, tractions on the contacts, values under the pointer.

class Bodies extends BodiesPicture {
  constructor(host) {
    super();
    this.host = host;
    this.runs = DATA.runs.filter((run) => run.solid && run.solid.frames.length);
    this.options = { map: "viridis", edges: null, tractions: true, bars: "axial_force", range: "most", fixed: [0, 1] };
    this.stage = el("div", { class: "view stage", tabindex: 0, role: "application",
      "aria-label": "Deformed bodies: left and right arrows step through time, space plays, plus and minus zoom" });
    this.over = el("canvas");
    this.probe = el("div", { class: "probe", "aria-live": "polite" });
    this.bar = new ColourBar();
    this.slider = el("input", { type: "range", min: 0, value: 0, step: 1, "aria-label": "Time", oninput: () => this.show(+this.slider.value) });
    this.clock = el("output", {});
    this.play = button("▶", "Play", () => this.toggle());
    this.controls = el("div", { class: "controls" });
    this.precision = el("p", { class: "facts" });
    this.steps = el("div", { class: "steps" });
    const times = el("div", { class: "times" }, this.slider, this.steps);
    host.append(this.controls, el("div", { class: "controls" }, this.play, times, this.clock), this.stage, this.probe, this.bar.element, this.precision);
    this.stage.append(this.over);
    this.listen();
    now.hear(this, (time) => this.show(nearest(this.solid.frames.map((frame) => frame.time), time), true));
    addEventListener("theme", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(this.stage);
    this.drawn = 0;
  }

  /** Another run: its mesh, fields and frames. */
  async open(run) {
    this.run = run;
    this.solid = run.solid;
    // Until one of its frames is shown there is none to draw: that of the run before may lie beyond its last.
    this.frame = null;
    const { solid } = this;
    const [places, connectivity, ends, kinds, bodies] = await Promise.all([
      unpack(solid.places), unpack(solid.connectivity, "u32"), unpack(solid.ends, "u32"), unpack(solid.kinds, "u8"),
      solid.body ? unpack(solid.body, "u32") : []]);
    Object.assign(this, { places, mesh: { connectivity, ends, kinds, bodies } });
    this.contact = run.contact && run.contact.frames.length ? await this.surfaces(run.contact) : null;
    this.bars = run.bars && run.bars.frames.length ? await barsOf(run, solid) : null;
    this.listed = stepsOf(await table(run.history));
    if (this.scene) this.stage.querySelector("canvas:first-child").remove();
    this.scene = scene(this.stage, solid.cells);
    this.canvas = this.stage.querySelector("canvas");
    this.uncover([]);
    this.scene.colours(this.options.map);
    if (this.options.edges == null) this.options.edges = solid.cells <= 6000;
    this.fields = fieldsOf(solid);
    const known = this.fields.find((field) => field.key === this.field?.key);
    const moving = this.fields.find((field) => field.name === "displacement" && field.part === "size");
    const stressed = this.fields.find((field) => field.name === "von_mises" && span(solid, field)[1] > 0);
    this.field = known || stressed || moving || this.fields[0];
    const percent = (error) => `${told(100 * error, 1)} %`;
    this.precision.textContent = `Values are shown to ${percent(solid.errors.fields)} of the largest in each frame, displacements to ` +
      `${percent(solid.errors.displacement)} of the largest of the run; the files hold more digits.`;
    this.scale = niceScale(solid, bounds(places));
    this.slider.max = solid.frames.length - 1;
    this.nameSteps();
    this.makeControls();
    this.resize();
    await this.fit();
    const frames = solid.frames.map((frame) => frame.time);
    await this.show(now.time == null ? frames.length - 1 : nearest(frames, now.time), true);
    this.ahead();
  }

  /** Draws the mesh without the bodies that are absent. */
  uncover(hidden) {
    this.hidden = `${hidden}`;
    this.scene.mesh(this.places, shapes(this.mesh, this.solid.points, hidden));
  }

  /** Points and lines of the contacts. */
  async surfaces(contact) {
    const [places, connectivity, ends] = await Promise.all([
      unpack(contact.places), unpack(contact.connectivity, "u32"), unpack(contact.ends, "u32")]);
    const lines = [];
    ends.forEach((end, e) => lines.push(connectivity.subarray(e ? ends[e - 1] : 0, end)));
    const shift = [0, 1].map((i) => contact.origin[i] - this.solid.origin[i]);
    const largest = Math.max(...contact.frames.map((frame) => {
      const most = (name) => Math.max(...(frame.fields[name]?.components[0].range || [0]).map(Math.abs));
      return Math.hypot(most("pressure"), most("traction"));
    }));
    return { ...contact, places, lines, shift, largest };
  }

  makeControls() {
    const { options } = this;
    const redraw = (change) => (value) => {
      change(value);
      this.draw();
    };
    const runs = this.runs.length > 1
      ? choice("run", this.runs.map((run, k) => [k, run.name]), this.runs.indexOf(this.run), (k) => this.open(this.runs[k])) : null;
    const field = choice("field", this.fields.map((one) => [one.key, one.label]), this.field.key, (key) => {
      this.field = this.fields.find((one) => one.key === key);
      this.show(this.frame, true);
      this.ahead();
    });
    const range = choice("colours span", [["most", "most of the run"], ["run", "all of the run"], ["frame", "this frame"], ["fixed", "fixed"]], options.range, (how) => {
      options.fixed = [...this.range()];
      options.range = how;
      this.showLimits();
      this.draw();
    });
    const limit = (k) => el("input", { type: "number", step: "any", "aria-label": k ? "highest colour" : "lowest colour",
      onchange: (event) => redraw(() => (options.fixed[k] = +event.target.value))() });
    this.limits = [limit(0), limit(1)];
    const scale = el("input", { type: "number", min: 0, step: "any", value: this.scale, "aria-label": "scale of displacement",
      onchange: () => redraw(() => (this.scale = Math.max(0, +scale.value || 0)))() });
    this.scaleInput = scale;
    const coloured = this.solid.cells > 0;
    this.controls.replaceChildren(...[runs, ...(coloured ? [field, range, ...this.limits,
      choice("map", Object.keys(MAPS).map((name) => [name, name]), options.map, redraw((map) => {
        options.map = map;
        this.scene.colours(map);
      })), check("elements", options.edges, redraw((on) => (options.edges = on)))] : []),
      el("label", {}, "displacement × ", scale),
      this.contact && this.contact.largest > 0 ? check("tractions", options.tractions, redraw((on) => (options.tractions = on))) : null,
      this.bars ? choice("bars", this.bars.choices, options.bars, redraw((name) => (options.bars = name))) : null,
      button("+", "Zoom in", () => this.zoom(1.4)), button("−", "Zoom out", () => this.zoom(1 / 1.4)),
      button("⤢", "Show all of the bodies", () => this.fit().then(() => this.draw())),
      ...exports(() => `${this.title()} ${this.frame}`, () => this.svg(), () => this.csv())].filter(Boolean));
    this.showLimits();
  }

  showLimits() {
    const fixed = this.options.range === "fixed";
    this.limits.forEach((input, k) => {
      input.hidden = !fixed;
      if (fixed) input.value = Number(this.options.fixed[k].toPrecision(4));
    });
  }

  /** Displacements and values of a frame: at once, or when they are unpacked. */
  need(k) {
    const frame = this.solid.frames[k];
    const chunks = [frame.displacement, ...this.field.chunks(frame)].filter(Boolean);
    return { frame, chunks, at_hand: chunks.every((chunk) => peek(chunk)) };
  }

  async show(k, quiet = false) {
    if (!this.solid) return;
    this.wanted = Math.max(0, Math.min(this.solid.frames.length - 1, k));
    const { run, wanted } = this;
    const { frame, chunks, at_hand } = this.need(wanted);
    if (!at_hand) await Promise.all(chunks.map((chunk) => unpack(chunk)));
    const [contact] = this.contact ? [this.contactFrame(frame.time)] : [null];
    if (contact) {
      await Promise.all([contact.displacement, contact.fields.pressure?.components[0].chunk, contact.fields.traction?.components[0].chunk]
        .filter((chunk) => chunk && !peek(chunk)).map((chunk) => unpack(chunk)));
    }
    if (this.bars) await this.bars.need(frame.time);
    if (this.wanted !== wanted || this.run !== run) return;
    this.frame = wanted;
    if (this.hidden !== `${frame.hidden}`) this.uncover(frame.hidden);
    this.slider.value = wanted;
    this.moved = (frame.displacement && peek(frame.displacement)) || new Float32Array(2 * this.solid.points);
    this.values = this.field.values(frame, this);
    this.scene.frame(this.moved, this.values);
    const step = stepAt(this.listed, frame.time);
    this.clock.value = `${step ? `${step.name}, ` : ""}t = ${timed(frame.time)} (${wanted + 1}/${this.solid.frames.length})`;
    this.steps.childNodes.forEach((one) => one.setAttribute("aria-current", String(one.step === step)));
    this.slider.setAttribute("aria-valuetext", this.clock.value);
    if (!quiet) now.set(frame.time, this);
    this.draw();
  }

  /** The names of the steps below the slider, each as wide as its frames are; a click goes to the end of a step. */
  nameSteps() {
    const { frames } = this.solid;
    const of = frames.map((frame) => stepAt(this.listed, frame.time));
    const named = this.listed.map((step) => ({ step, count: of.filter((other) => other === step).length })).filter(({ count }) => count > 0);
    this.steps.hidden = named.length < 2;
    this.steps.replaceChildren(...named.map(({ step, count }) => {
      const made = button(step.name, `Step ${step.name}: to its end`, () => this.show(of.lastIndexOf(step)));
      made.style.flexGrow = count;
      return Object.assign(made, { step });
    }));
  }

  toggle() {
    this.playing = !this.playing;
    this.play.textContent = this.playing ? "❚❚" : "▶";
    this.play.title = this.playing ? "Pause" : "Play";
    if (!this.playing) return;
    if (this.frame === this.solid.frames.length - 1) this.frame = -1;
    const next = async () => {
      if (!this.playing) return;
      const begun = performance.now();
      await this.show(this.frame + 1);
      if (this.frame >= this.solid.frames.length - 1) return this.toggle();
      setTimeout(() => requestAnimationFrame(next), Math.max(0, 80 - (performance.now() - begun)));
    };
    next();
  }

  listen() {
    const { stage } = this;
    let held = null;
    stage.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      stage.setPointerCapture(event.pointerId);
    });
    stage.addEventListener("pointerup", () => (held = null));
    stage.addEventListener("pointermove", (event) => {
      if (held) {
        this.move(event.clientX - held[0], event.clientY - held[1]);
        held = [event.clientX, event.clientY];
      } else this.tell(event.offsetX, event.offsetY);
    });
    stage.addEventListener("wheel", (event) => {
      // Whoever only scrolls past is let pass.
      if (document.activeElement !== stage && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
    }, { passive: false });
    stage.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 10 : 1;
      const keys = {
        ArrowLeft: () => this.show(this.frame - step), ArrowRight: () => this.show(this.frame + step),
        Home: () => this.show(0), End: () => this.show(Infinity), " ": () => this.toggle(),
        "+": () => this.zoom(1.4), "=": () => this.zoom(1.4), "-": () => this.zoom(1 / 1.4), 0: () => this.fit().then(() => this.draw()),
        w: () => this.move(0, 40), s: () => this.move(0, -40), a: () => this.move(40, 0), d: () => this.move(-40, 0),
      };
      if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      keys[event.key]();
    });
  }

  /** Unpack the other frames while nothing else is asked for. */
  async ahead() {
    const turn = (this.turn = {});
    for (let k = 0; k < this.solid.frames.length && keptBytes < 0.6 * ROOM; k++) {
      await new Promise((done) => setTimeout(done, 5));
      if (this.turn !== turn) return;
      await Promise.all(this.need(k).chunks.map((chunk) => unpack(chunk)));
    }
  }
}

let bodiesView = null;
async function showBodies() {
  const section = document.getElementById("bodies");
  if (!DATA.runs.some((run) => run.solid && run.solid.frames.length)) return;
  section.hidden = false;
  bodiesView = new Bodies(section);
  await bodiesView.open(bodiesView.runs[0]);
}
