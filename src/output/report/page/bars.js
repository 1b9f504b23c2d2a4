"use strict";
// Bars on the picture of the bodies, with a diagram of a force along them.

/** What may be drawn along bars, by its name in the files. */
const ALONG_BARS = ["axial_force", "moment", "shear_force", "bond_shear", "bond_normal", "slip"];

/** Height of the highest diagram [px]. */
const DIAGRAM = 45;

class Bars {
  constructor(run, solid, places, ends, owner) {
    const { frames, origin } = run.bars;
    Object.assign(this, { frames, places, ends, owner, shift: [0, 1].map((i) => origin[i] - solid.origin[i]) });
    const size = (name) => Math.max(0, ...frames.flatMap((frame) => frame.fields[name]?.components[0].range || []).map(Math.abs));
    this.largest = Object.fromEntries(ALONG_BARS.map((name) => [name, size(name)]));
    const known = ALONG_BARS.filter((name) => this.largest[name] > 0);
    this.choices = [...known.map((name) => [name, spoken(name)]), ["", "lines only"]];
  }

  at(time) {
    return this.frames.find((frame) => frame.time === time);
  }

  /** Unpacks what a frame needs. */
  async need(time) {
    const frame = this.at(time);
    if (!frame) return;
    const chunks = [frame.displacement, ...ALONG_BARS.map((name) => frame.fields[name]?.components[0].chunk)];
    await Promise.all(chunks.filter((chunk) => chunk && !peek(chunk)).map((chunk) => unpack(chunk)));
  }

  draw(context, view, w, h) {
    const frame = this.at(view.solid.frames[view.frame].time);
    if (!frame) return;
    const { places, ends, owner, shift } = this;
    const moved = frame.displacement && peek(frame.displacement);
    const place = (k) => view.at(...[0, 1].map((i) => places[2 * k + i] + shift[i] + (moved ? view.scale * moved[2 * k + i] : 0)), w, h);
    const segments = [...owner.keys()].filter((k) => !frame.hidden.includes(owner[k]));
    if (view.options.bars) this.diagram(context, frame, view.options.bars, segments.map((k) => [k, place(ends[2 * k]), place(ends[2 * k + 1])]));
    context.strokeStyle = styled("--ink");
    context.lineWidth = 3;
    context.beginPath();
    for (const k of segments) {
      context.moveTo(...place(ends[2 * k]));
      context.lineTo(...place(ends[2 * k + 1]));
    }
    context.stroke();
    context.lineWidth = 1;
  }

  /** A force along bars as the height above them, to their left where it is positive; its largest is written. */
  diagram(context, frame, name, segments) {
    const values = peek(frame.fields[name]?.components[0].chunk);
    if (!values || !(this.largest[name] > 0)) return;
    const ofSegments = values.length === this.owner.length;
    const value = (k, end) => values[ofSegments ? k : this.ends[2 * k + end]];
    let most = [0, [0, 0]];
    context.fillStyle = "#e69f0080";
    context.strokeStyle = "#d55e00";
    context.lineWidth = 1.4;
    for (const [k, a, b] of segments) {
      const size = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      // On the canvas y points down: left of the way from a to b.
      const left = [(b[1] - a[1]) / size, -(b[0] - a[0]) / size];
      const tips = [a, b].map((from, end) => from.map((x, i) => x + (left[i] * DIAGRAM * value(k, end)) / this.largest[name]));
      [0, 1].forEach((end) => {
        if (Math.abs(value(k, end)) > Math.abs(most[0])) most = [value(k, end), tips[end]];
      });
      context.beginPath();
      context.moveTo(...a);
      context.lineTo(...tips[0]);
      context.lineTo(...tips[1]);
      context.lineTo(...b);
      context.fill();
      context.beginPath();
      context.moveTo(...tips[0]);
      context.lineTo(...tips[1]);
      context.stroke();
    }
    if (!most[0]) return;
    const text = `${spoken(name)} ${told(most[0], 3)} ${fieldUnit(name)}`.trimEnd();
    context.strokeStyle = styled("--paper");
    context.lineJoin = "round";
    context.lineWidth = 3;
    context.strokeText(text, most[1][0] + 6, most[1][1] - 4);
    context.fillStyle = styled("--ink");
    context.fillText(text, most[1][0] + 6, most[1][1] - 4);
  }
}

async function barsOf(run, solid) {
  const { bars } = run;
  const [places, ends, owner] = await Promise.all([unpack(bars.places), unpack(bars.connectivity, "u32"), unpack(bars.body, "u32")]);
  return new Bars(run, solid, places, ends, owner);
}

/** Charts of the forces of a bar over time. */
function barCharts(runs, bar) {
  const of = (columns) => columns.map(([name, label]) => [`${bar}.${name}`, label]);
  return [
    overTime(runs, `Axial force of ${bar}`, of([["axial_max", "largest"], ["axial_min", "smallest"]]), "axial force", unitOf("force")),
    overTime(runs, `Moment of ${bar}`, of([["moment_max", "largest |M|"]]), "moment", unitOf("energy")),
    overTime(runs, `Slip of the bond of ${bar}`, of([["bond_slip_max", "largest"]]), "slip", unitOf("length")),
  ];
}
