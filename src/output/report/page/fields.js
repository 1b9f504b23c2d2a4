"use strict";
// What can be shown of the bodies in colours.

/** What stands for no number on the graphics card. */
const NO_NUMBER = 3e38;
const isNumber = (value) => value < 1e30;

/** What can be shown in colours. */
function fieldsOf(solid) {
  const fields = [];
  const add = (name, part, label, chunks, values, range) =>
    fields.push({ key: `${name}.${part}`, name, part, label, unit: fieldUnit(name), chunks, values, range });
  const vector = (name, ofFrame) => {
    add(name, "size", `|${spoken(name)}|`, (frame) => ofFrame(frame).chunks, (frame) => {
      const [x, y] = ofFrame(frame).parts();
      return x.map((value, k) => blankless(Math.hypot(value, y[k])));
    }, (frame, _, most) => [0, ofFrame(frame).longest[most ? 1 : 0]]);
  };
  if (solid.frames[0].displacement) {
    const of = (frame) => ({
      chunks: [frame.displacement], longest: [frame.largest, frame.largest],
      parts: () => [0, 1].map((i) => Float32Array.from({ length: solid.points }, (_, k) => peek(frame.displacement)[2 * k + i])),
    });
    vector("displacement", of);
    ["x", "y"].forEach((axis, i) =>
      add("displacement", axis, `displacement ${axis}`, (frame) => of(frame).chunks,
        (frame) => of(frame).parts()[i].map(blankless), (frame) => [-frame.largest, frame.largest]));
  }
  for (const [name, { components }] of Object.entries(solid.frames[0].fields)) {
    const of = (frame, i) => frame.fields[name]?.components[i];
    const parts = { 2: ["x", "y"], 4: ["xx", "yy", "zz", "xy"] }[components.length] || components.map((_, i) => `${i + 1}`);
    const all = solid.frames.flatMap((frame) => frame.fields[name]?.components.flatMap((one) => one.range) || []);
    if (all.every((value) => value === 0)) continue;
    if (components.length === 2) {
      vector(name, (frame) => ({
        chunks: [of(frame, 0).chunk, of(frame, 1).chunk], longest: frame.fields[name].longest,
        parts: () => [peek(of(frame, 0).chunk), peek(of(frame, 1).chunk)],
      }));
    }
    components.forEach((_, i) =>
      add(name, `${i}`, components.length > 1 ? `${spoken(name)} ${parts[i]}` : spoken(name), (frame) => [of(frame, i).chunk],
        (frame) => peek(of(frame, i).chunk).map(blankless), (frame, _, most) => of(frame, i)[most ? "most" : "range"]));
    const chunks = (frame) => components.map((_, i) => of(frame, i).chunk);
    const derived = { stress: "principal_stress", log_strain: "principal_strain" }[name];
    if (derived && components.length === 4 && !solid.frames[0].fields[derived]) {
      [0, 1, 2].forEach((i) =>
        add(derived, `${i}`, `${spoken(derived)} ${i + 1}`, chunks, (frame) => principalValues(chunks(frame).map(peek), i),
          (frame, _, most) => frame.fields[name].principal[i][most ? 1 : 0]));
    }
    if (name === "log_strain" && !solid.frames[0].fields.stretch_zz && all.some((value) => value !== 0)) {
      add("stretch_zz", "0", spoken("stretch_zz"), (frame) => [of(frame, 2).chunk], (frame) => peek(of(frame, 2).chunk).map((e) => blankless(Math.exp(e))),
        (frame, _, most) => of(frame, 2)[most ? "most" : "range"].map(Math.exp));
    }
  }
  if (solid.body && solid.cells) {
    add("body", "id", "body", () => [], (_, view) => bodyOfNodes(view), (_, view) => [0, Math.max(1, ...(view ? bodyOfNodes(view) : [1]))]);
  }
  return fields;
}

/** One of the principal values of tensors xx, yy, zz, xy, the largest first. */
function principalValues([xx, yy, zz, xy], i) {
  return xx.map((x, k) => {
    const [middle, radius] = [(x + yy[k]) / 2, Math.hypot((x - yy[k]) / 2, xy[k])];
    return blankless([middle + radius, middle - radius, zz[k]].sort((a, b) => b - a)[i]);
  });
}

const blankless = (value) => (Number.isNaN(value) ? NO_NUMBER : value);

/** Number of the body that a node belongs to. */
function bodyOfNodes(view) {
  if (view.bodies?.solid === view.solid) return view.bodies.of;
  const of = new Float32Array(view.solid.points);
  const { connectivity, ends } = view.mesh;
  const ids = peek(view.solid.body);
  ends.forEach((end, e) => {
    for (let k = e ? ends[e - 1] : 0; k < end; k++) of[connectivity[k]] = ids ? ids[e] : 0;
  });
  if (ids) view.bodies = { solid: view.solid, of };
  else unpack(view.solid.body, "u32").then(() => view.show(view.frame, true));
  return of;
}

/** Range of a field over some frames. */
function span(solid, field, view, most = false) {
  const ranges = solid.frames.map((frame) => field.range(frame, view, most));
  return [Math.min(...ranges.map(([low]) => low)), Math.max(...ranges.map(([, high]) => high))];
}

/** By how much displacements are enlarged at first: not, if they can be seen as they are. */
function niceScale(solid, [low, high]) {
  const share = solid.largest / (high - low || 1);
  if (!(share > 0) || share > 0.01 || !solid.cells) return 1;
  return roundBelow(0.03 / share);
}

/** 1, 2 or 5 times a power of ten, not above a number. */
function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [5, 2, 1].find((k) => k * power <= value * (1 + 1e-9));
}
