"use strict";
// Profiles along a surface at chosen times: pressure on a wall over depth, settlement of the ground, slip of a fault every few years.

/** Curves that are named in the legend, and that are drawn at all. */
const [LISTED, CURVES_MOST] = [8, 300];

class Profiles {
  constructor(host, surfaces) {
    Object.assign(this, { host, surfaces, mode: null });
    this.controls = el("div", { class: "controls" });
    this.chart = new Chart({ title: "Profiles", x: { label: "" }, y: { label: "" }, series: [], path: true, height: 340 });
    this.note = el("p", { class: "facts" });
    host.append(this.controls, this.chart.element, this.note);
    now.hear(this, () => this.mode === "now" && this.show());
  }

  async open(surface) {
    this.surface = surface;
    await surface.open();
    const { run, quantities } = surface;
    this.steps = stepsOf(await table(run.history));
    this.events = await this.eventsHere();
    const first = ["slip", "pressure", "displacement.y"].filter((key) => key !== "slip" || this.events.length);
    this.quantity = quantities.find((one) => one.key === this.quantity?.key) || first.map((key) => quantities.find((one) => one.key === key)).find(Boolean) || quantities[0];
    const [width, height] = surface.extents();
    this.axis = height > 2 * width ? "y" : width > 2 * height ? "x" : "along";
    const { times } = surface;
    const total = (times[times.length - 1] - Math.min(0, times[0])) / clock.size;
    this.every = roundBelow(total / (this.events.length ? 25 : 10)) || 1;
    this.quick = roundBelow((median(this.events.map(({ duration }) => duration)) || 0) / 8) || 0;
    this.mode ??= this.events.length ? "every" : this.steps.length > 1 && this.steps.length <= LISTED ? "ends" : "even";
    this.makeControls();
    await this.show();
  }

  /** Events of the contacts of the surface. */
  async eventsHere() {
    const { surface } = this;
    const events = surface.pieces ? await table(surface.run.events) : null;
    if (!events?.get("onset") || !events.get("duration")) return [];
    const names = surface.pieces.map(({ map }) => map.contact);
    const rows = Array.from({ length: events.rows }, (_, row) => row).filter((row) => names.includes(events.get("contact")?.[row]));
    return rows.map((row) => ({ onset: events.get("onset")[row], duration: events.get("duration")[row] }));
  }

  makeControls() {
    const { surface, surfaces } = this;
    const again = (change) => (value) => {
      change(value);
      this.makeControls();
      this.show();
    };
    const label = (one) => (several ? `${one.run.name}: ${one.name}` : one.name);
    const interval = (text, value, unit, take) => el("label", {}, `${text} `, el("input", { type: "number", min: 0, step: "any", value: Number(value.toPrecision(4)),
      "aria-label": `${text} ${unit}`, onchange: (event) => again(take)(Math.max(0, +event.target.value || 0)) }), ` ${unit}`);
    const modes = [["ends", "ends of steps"], ["even", "evenly apart"], ["every", "at intervals"], ["now", "chosen time"]];
    this.controls.replaceChildren(...[
      choice("surface", surfaces.map((one, k) => [k, label(one)]), surfaces.indexOf(surface), (k) => this.open(surfaces[k])),
      choice("quantity", surface.quantities.map((one) => [one.key, one.label]), this.quantity.key,
        again((key) => (this.quantity = surface.quantities.find((one) => one.key === key)))),
      choice("along", [["along", "length"], ["x", "x"], ["y", "y, upwards"]], this.axis, again((axis) => (this.axis = axis))),
      choice("times", modes, this.mode, again((mode) => (this.mode = mode))),
      this.mode === "every" ? interval("every", this.every, clock.unit, (value) => (this.every = value)) : null,
      this.mode === "every" && this.events.length ? interval("in events every", this.quick, unitOf("time"), (value) => (this.quick = value)) : null,
    ].filter(Boolean));
  }

  /** Times at which profiles are drawn: [time, its name, whether it is within an event]. */
  moments() {
    const { surface: { times }, mode, steps, events } = this;
    const [begin, end] = [Math.min(0, times[0]), times[times.length - 1]];
    const plain = (time) => [time, `t = ${timed(time)}`, false];
    if (mode === "now") return [plain(now.time ?? end)];
    if (mode === "ends" && steps.length) return steps.map(({ name, to }) => [to, `${name}, t = ${timed(to)}`, false]);
    const spaced = (from, to, step) => Array.from({ length: Math.min(CURVES_MOST, Math.floor((to - from) / step * (1 + 1e-9)) + 1) }, (_, k) => from + k * step);
    if (mode !== "every" || !(this.every > 0)) return Array.from({ length: SNAPSHOTS }, (_, k) => plain(begin + ((end - begin) * k) / (SNAPSHOTS - 1)));
    const slow = spaced(begin, end, this.every * clock.size).map(plain);
    const fast = this.quick > 0 ? events.flatMap(({ onset, duration }) => spaced(onset, onset + duration, this.quick)) : [];
    return [...slow, ...fast.map((time) => [time, `event, t = ${timed(time, 10)}`, true])].sort((a, b) => a[0] - b[0]).slice(0, CURVES_MOST);
  }

  async show() {
    const { surface, quantity, axis } = this;
    const turn = (this.turn = {});
    const seen = new Set();
    // Of moments that share a row of the results the first is drawn.
    const moments = this.moments().map((moment) => [nearest(surface.times, moment[0]), moment]).filter(([row]) => !seen.has(row) && seen.add(row));
    const lut = lutOf("viridis");
    const along = axis === "along" ? surface.along : Float64Array.from(surface.places, (place) => place[axis === "x" ? 0 : 1]);
    const series = [];
    for (const [k, [row, [, name, fast]]] of moments.entries()) {
      const values = Float64Array.from(await surface.values(quantity, surface.times[row]));
      const from = 4 * Math.round(60 + (150 * k) / Math.max(1, moments.length - 1));
      const colour = fast ? "#d55e00" : `rgb(${lut.slice(from, from + 3).join(" ")})`;
      const unlisted = moments.length > LISTED && k > 0 && k < moments.length - 1;
      series.push({ name, ...(axis === "y" ? { x: values, y: along } : { x: along, y: values }), colour, dash: fast ? [3, 3] : [], plain: true, unlisted });
    }
    if (this.turn !== turn) return;
    const labels = [withUnit(axis === "along" ? "position along the surface" : axis, unitOf("length")), withUnit(quantity.label, quantity.unit)];
    const [x, y] = (axis === "y" ? [...labels].reverse() : labels).map((label) => ({ label }));
    this.chart.set(series, `${quantity.label} along ${surface.name}`, y, x);
    const dashed = moments.filter(([, [, , fast]]) => fast).length;
    this.note.textContent = moments.length <= LISTED ? "" : `${moments.length} profiles, from dark to light${dashed ? `; ${dashed} of them in events (dashed)` : ""}.`;
  }
}

let profilesView = null;
async function showProfiles() {
  const found = await Promise.all(DATA.runs.map(async (run) => [...await contactSurfaces(run), ...await bodySurfaces(run)]));
  const surfaces = found.flat();
  if (!surfaces.length) return;
  document.getElementById("profiles").hidden = false;
  profilesView = new Profiles(document.getElementById("profiles"), surfaces);
  await profilesView.open(surfaces[0]);
}
