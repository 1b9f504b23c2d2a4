"use strict";
// An interface over place and time as a picture: a click chooses a time and a place, and shows the profile and the history there;
// snapshots show profiles at some times of the picture.

/** Profiles of a picture, from its first time to its last. */
const SNAPSHOTS = 6;

class Interface extends InterfacePicture {
  constructor(host) {
    super();
    this.host = host;
    this.maps = DATA.runs.flatMap((run) => run.interfaces.map((map) => ({ run, map })));
    this.settings = { colours: "viridis", log: false, axis: "time", waves: true, fronts: true, most: true };
    this.controls = el("div", { class: "controls" });
    this.view = el("div", { class: "view map", tabindex: 0, role: "application",
      "aria-label": "Interface over place and time: arrows choose time and place, plus and minus zoom" });
    this.canvas = el("canvas");
    this.view.append(this.canvas);
    this.probe = el("div", { class: "probe", "aria-live": "polite" });
    this.bar = new ColourBar();
    const place = { label: withUnit("position along the slave", unitOf("length")) };
    this.profile = new Chart({ title: "Profile", x: place, y: { label: "" }, series: [], click: (x) => this.choose(null, x) });
    this.history = new Chart({ title: "History", x: timeAxis(), y: { label: "" }, series: [], time: true });
    this.snapshots = new Chart({ title: "Snapshots", x: place, y: { label: "" }, series: [] });
    this.picture = el("div", {}, this.view, this.probe, this.bar.element);
    this.rates = new Rates();
    host.append(this.controls, this.picture, el("div", { class: "grid" }, this.profile.element, this.history.element, this.snapshots.element,
      ...this.rates.charts.map((chart) => chart.element)));
    this.listen();
    now.hear(this, (time) => this.choose(time, null, true));
    addEventListener("theme", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.view);
  }

  async open(k) {
    const { run, map } = this.maps[k];
    Object.assign(this, { number: k, run, map });
    [this.times, this.places] = await Promise.all([unpack(map.times, "f64"), unpack(map.positions, "f64")]);
    this.fronts = await table(run.fronts);
    this.longest = this.fronts ? Math.max(0, ...eventsOf(this.fronts).filter((event) => event.contact === map.contact).map((event) => event.duration)) : 0;
    const known = map.quantities.find((one) => one.name === this.quantity?.name);
    const first = ["slip_rate", "traction", "R", "pressure"].map((name) => map.quantities.find((one) => one.name === name && one.range[0] !== one.range[1]));
    this.all();
    this.chosen = { row: this.times.length - 1, point: this.places.length >> 1 };
    this.fresh = true;
    this.picture.hidden = map.points < 2;
    await this.show(known || (run.fronts || map.rows > 300 ? first.find(Boolean) : first.slice(1).find(Boolean)) || map.quantities[0]);
    if (now.time != null) this.choose(now.time, null, true);
    await this.rates.show(run, map);
  }

  /** Another quantity. */
  async show(quantity, log = null) {
    this.quantity = quantity;
    this.values = await unpack(quantity.chunk);
    this.mostly = most(this.values);
    this.settings.log = log ?? quantity.name.endsWith("rate");
    if (this.fresh) this.chosen.point = this.busiest();
    this.fresh = false;
    this.makeControls();
    this.look();
    await this.charts();
  }

  /** The picture of another window, and the profiles in it. */
  look() {
    this.draw();
    this.showSnapshots();
  }

  /** Profiles of the picture at times evenly apart in it, the peak of friction beside a traction. */
  async showSnapshots() {
    const { map, quantity, places, window } = this;
    this.snapshots.element.hidden = map.points < 2 || map.rows < 2;
    if (this.snapshots.element.hidden) return;
    const [low, high] = window.t;
    const shares = Array.from({ length: SNAPSHOTS }, (_, k) => k / (SNAPSHOTS - 1));
    const rows = [...new Set(shares.map((share) => this.rowAt(low + share * (high - low))))];
    const strength = ["mu", "pressure"].map((name) => quantity.name === "traction" && map.quantities.find((one) => one.name === name));
    const [values, ...factors] = await Promise.all([quantity, ...strength.filter(Boolean)].map((one) => unpack(one.chunk)));
    if (this.quantity !== quantity || this.map !== map) return;
    const lut = lutOf("viridis");
    const series = rows.flatMap((row, k) => {
      // The lightest colours of the map cannot be seen on white, the darkest not on black.
      const from = 4 * Math.round(60 + (150 * k) / Math.max(1, rows.length - 1));
      const colour = `rgb(${lut.slice(from, from + 3).join(" ")})`;
      const along = (of) => Float64Array.from(places, (_, i) => of(row * places.length + i));
      const name = `t = ${timed(this.times[row])}`;
      const profile = { name, x: places, y: along((i) => values[i]), colour, plain: true };
      if (factors.length < 2) return [profile];
      return [profile, { name: `μ p, ${name}`, x: places, y: along((i) => factors[0][i] * factors[1][i]), colour, dash: [3, 3], plain: true, unlisted: true }];
    });
    const title = `Snapshots of ${map.contact}${factors.length < 2 ? "" : ", q and μ p (dotted)"}`;
    this.snapshots.set(series, title, { label: withUnit(spoken(quantity.name), fieldUnit(quantity.name)) });
  }

  makeControls() {
    const { settings, map } = this;
    const redraw = (change) => (value) => {
      change(value);
      this.draw();
    };
    const boxes = [
      choice("colours span", [["most", "most"], ["", "all"]], settings.most ? "most" : "", redraw((how) => (settings.most = how === "most"))),
      check("logarithmic", settings.log, redraw((on) => (settings.log = on))),
      check("wave speeds", settings.waves, redraw((on) => (settings.waves = on))),
      this.fronts ? check("fronts", settings.fronts, redraw((on) => (settings.fronts = on))) : null,
    ];
    this.controls.replaceChildren(...[
      this.maps.length > 1 ? choice("interface", this.maps.map(({ run, map }, k) => [k, several ? `${run.name}: ${map.contact}` : map.contact]), this.number,
        (k) => this.open(+k)) : null,
      choice("quantity", map.quantities.map((one) => [one.name, spoken(one.name)]), this.quantity.name,
        (name) => this.show(map.quantities.find((one) => one.name === name))),
      ...(map.points > 1 ? [
        choice("map", Object.keys(MAPS).map((name) => [name, name]), settings.colours, redraw((name) => (settings.colours = name))),
        choice("upwards", [["time", "time"], ["row", "output row"]], settings.axis, (axis) => {
          settings.axis = axis;
          this.all();
          this.look();
        }), ...boxes,
        button("+", "Zoom in at the chosen time and place", () => this.zoom(0.5)), button("−", "Zoom out", () => this.zoom(2)),
        button("⤢", "Show all", () => this.whole()),
        ...exports(() => this.title(), () => this.svg(), () => this.csv()),
      ] : []),
    ].filter(Boolean));
  }

  /** Choose a time, or a place, or both. */
  choose(time, place, quiet = false) {
    if (!this.values) return;
    if (time != null) this.chosen.row = this.times.length > 1 ? nearest(this.times, time) : 0;
    if (place != null) this.chosen.point = nearest(this.places, place);
    this.draw();
    if (!quiet && time != null) now.set(this.times[this.chosen.row], this);
    this.charts();
  }

  /** Profile at the chosen time, history at the chosen place, with the limits of friction beside the tractions. */
  async charts() {
    const turn = (this.turn = {});
    const { row, point } = this.chosen;
    const series = { profile: [], history: [] };
    const others = this.maps.filter(({ map }) => map.contact === this.map.contact);
    const names = ["traction", "pressure"].includes(this.quantity.name) ? ["traction", "pressure", "μ p"] : [this.quantity.name];
    const time = this.times[row];
    for (const { run, map } of others) {
      const [times, places] = await Promise.all([unpack(map.times, "f64"), unpack(map.positions, "f64")]);
      const of = async (name) => {
        const packed = map.quantities.find((one) => one.name === name);
        return packed && unpack(packed.chunk);
      };
      const [near, beside] = [map === this.map ? row : nearest(times, time), map === this.map ? point : nearest(places, this.places[point])];
      for (const [column, name] of names.entries()) {
        const strength = name === "μ p";
        const [first, second] = strength ? [await of("mu"), await of("pressure")] : [await of(name)];
        if (!first || (strength && !second)) continue;
        const at = (i) => (strength ? first[i] * second[i] : first[i]);
        const label = strength ? "μ p" : spoken(name);
        const common = { name: nameOf(label, run, 2), ...look(DATA.runs.indexOf(run), column, names.length) };
        series.profile.push({ ...common, x: places, y: Float64Array.from(places, (_, i) => at(near * places.length + i)) });
        series.history.push({ ...common, x: times, y: Float64Array.from(times, (_, i) => at(i * places.length + beside)) });
      }
    }
    if (this.turn !== turn) return;
    const y = { label: withUnit(names.length > 1 ? "traction" : spoken(this.quantity.name), fieldUnit(this.quantity.name)) };
    const unit = (value, of) => `${value} ${unitOf(of)}`.trim();
    this.profile.element.hidden = this.map.points < 2;
    if (this.map.points > 1) this.profile.set(series.profile, `${this.map.contact} at t = ${timed(time, 9)}`, y);
    this.history.set(series.history, `${this.map.contact} at position ${unit(told(this.places[point]), "length")}`, y);
  }

  /** Close up on an event. */
  async goTo(run, contact, onset, duration) {
    const k = this.maps.findIndex((one) => one.run === run && (!contact || one.map.contact === contact));
    if (k < 0) return;
    if (k !== this.number) await this.open(k);
    const length = duration > 0 ? duration : 10 * (this.times[this.rowAt(onset)] - this.start(this.rowAt(onset)));
    this.settings.axis = "time";
    this.all();
    this.window.t = [onset - 0.15 * length, onset + 1.6 * length];
    this.makeControls();
    this.choose(onset, null, true);
    this.showSnapshots();
    this.host.scrollIntoView({ behavior: "smooth" });
  }

  whole() {
    this.all();
    this.look();
  }

  zoom(factor) {
    const { window, chosen } = this;
    const about = { s: this.places[chosen.point], t: this.up(chosen.row) };
    for (const axis of ["s", "t"]) window[axis] = window[axis].map((end) => about[axis] + (end - about[axis]) * factor);
    this.limit();
    this.look();
  }

  csv() {
    const { s, t } = this.window;
    const points = [...this.places.keys()].filter((k) => this.places[k] >= s[0] && this.places[k] <= s[1]);
    const rows = [...this.times.keys()].filter((k) => this.up(k) >= t[0] && this.up(k) <= t[1]);
    const length = unitOf("length");
    const names = [withUnit("time", unitOf("time")), ...points.map((k) => `position ${this.places[k]} ${length}`.trimEnd())];
    return csv(names, [rows.map((row) => this.times[row]), ...points.map((k) => rows.map((row) => this.values[row * this.places.length + k]))]);
  }

  listen() {
    const { view } = this;
    const inside = (event) => {
      const { box, window } = this;
      const [i, j] = [(event.offsetX - box.x) / box.w, 1 - (event.offsetY - box.y) / box.h];
      return [window.s[0] + i * (window.s[1] - window.s[0]), window.t[0] + j * (window.t[1] - window.t[0])];
    };
    let from = null;
    view.addEventListener("pointerdown", (event) => {
      if (!this.box) return;
      from = { x: event.offsetX, y: event.offsetY, at: inside(event) };
      view.setPointerCapture(event.pointerId);
    });
    view.addEventListener("pointermove", (event) => {
      if (!this.values || !this.box) return;
      const [s, up] = inside(event);
      const [row, point] = [this.rowAt(up), nearest(this.places, s)];
      this.probe.textContent = `t = ${timed(this.times[row], 9)}, position ${told(this.places[point])} ${unitOf("length")}: ` +
        `${spoken(this.quantity.name)} ${told(this.values[row * this.places.length + point])} ${fieldUnit(this.quantity.name)}`;
      if (!from) return;
      this.draw();
      const context = this.canvas.getContext("2d");
      context.strokeStyle = "#ffffff";
      context.strokeRect(from.x, from.y, event.offsetX - from.x, event.offsetY - from.y);
    });
    view.addEventListener("pointerup", (event) => {
      if (!from) return;
      const [[s0, t0], [s1, t1]] = [from.at, inside(event)];
      const dragged = Math.hypot(event.offsetX - from.x, event.offsetY - from.y) > 6;
      from = null;
      if (!dragged) return this.choose(this.times[this.rowAt(t1)], s1);
      if (Math.abs(s1 - s0) > 0 && Math.abs(t1 - t0) > 0) this.window = { s: [s0, s1].sort((a, b) => a - b), t: [t0, t1].sort((a, b) => a - b) };
      this.limit();
      this.look();
    });
    view.addEventListener("dblclick", () => this.whole());
    view.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 10 : 1;
      const to = (row, point) => this.choose(this.times[Math.max(0, Math.min(this.times.length - 1, this.chosen.row + row))],
        this.places[Math.max(0, Math.min(this.places.length - 1, this.chosen.point + point))]);
      const keys = {
        ArrowUp: () => to(step, 0), ArrowDown: () => to(-step, 0), ArrowLeft: () => to(0, -step), ArrowRight: () => to(0, step),
        "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2),
        0: () => this.whole(), Escape: () => this.whole(),
      };
      if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      keys[event.key]();
    });
  }
}

let interfaceView = null;
async function showInterface() {
  const section = document.getElementById("interface");
  if (!DATA.runs.some((run) => run.interfaces.some((map) => map.rows > 0 && map.quantities.length))) return;
  section.hidden = false;
  interfaceView = new Interface(section);
  await interfaceView.open(0);
}
