"use strict";
// Surfaces along which profiles are drawn: contacts, one after the other where they lie on one line, and sides of bodies.

/** Turn beyond which a surface ends [rad]. */
const CORNER = (35 * Math.PI) / 180;

/** Sides of bodies that are offered: the longest. */
const SIDES = 60;

const turn = (a, b) => Math.abs(Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]));

/** A surface: its places in order, and how far they are along it; `NaN` between parts that do not touch. */
class Surface {
  constructor(run, name, places) {
    Object.assign(this, { run, name, places, along: new Float64Array(places.length) });
    for (let k = 1; k < places.length; k++) {
      this.along[k] = this.along[k - 1] + Math.hypot(places[k][0] - places[k - 1][0], places[k][1] - places[k - 1][1]);
    }
  }

  /** Extents along x and y. */
  extents() {
    return [0, 1].map((i) => {
      const [low, high] = bounds(this.places.map((place) => place[i]));
      return high - low;
    });
  }
}

/** Contacts in a row: pieces are {map, first, last}. */
class ContactSurface extends Surface {
  constructor(run, name, pieces, places) {
    super(run, name, places);
    Object.assign(this, { pieces, times: null });
    const names = pieces[0].map.quantities.map((one) => one.name).filter((name) => name !== "state");
    this.quantities = names.filter((name) => pieces.every(({ map }) => map.quantities.some((one) => one.name === name)))
      .map((name) => ({ key: name, label: spoken(name), unit: fieldUnit(name) }));
  }

  async open() {
    this.times = await unpack(this.pieces[0].map.times, "f64");
  }

  async values(quantity, time) {
    const parts = await Promise.all(this.pieces.map(async ({ map, first, last }) => {
      const packed = map.quantities.find((one) => one.name === quantity.key);
      const [times, values] = await Promise.all([unpack(map.times, "f64"), unpack(packed.chunk)]);
      const start = nearest(times, time) * map.points;
      return values.slice(start + first, start + last + 1);
    }));
    return parts.flatMap((part) => [...part]);
  }
}

/** A side of a body, by its nodes. */
class BodySurface extends Surface {
  constructor(run, name, nodes, places) {
    super(run, name, nodes.map((node) => [0, 1].map((i) => places[2 * node + i] + run.solid.origin[i])));
    Object.assign(this, { nodes, times: run.solid.frames.map((frame) => frame.time) });
    this.quantities = fieldsOf(run.solid).filter((field) => field.name !== "body");
  }

  async open() {}

  async values(field, time) {
    const frame = this.run.solid.frames[nearest(this.times, time)];
    await Promise.all(field.chunks(frame).filter(Boolean).map((chunk) => unpack(chunk)));
    const values = field.values(frame, this);
    return this.nodes.map((node) => (isNumber(values[node]) ? values[node] : NaN));
  }
}

/** Lines of the contacts of a run. */
async function piecesOf(run) {
  const all = [];
  for (const map of run.interfaces.filter((one) => one.points > 1 && one.rows > 0)) {
    const [x, y, lines] = await Promise.all([...map.places.map((chunk) => unpack(chunk, "f64")), unpack(map.lines, "u32")]);
    for (let first = 0; first < map.points;) {
      let last = first;
      while (last + 1 < map.points && lines[last + 1] === lines[first]) last += 1;
      const places = Array.from({ length: last - first + 1 }, (_, k) => [x[first + k], y[first + k]]);
      if (last > first) all.push({ map, first, last, places });
      first = last + 1;
    }
  }
  return all;
}

/** Whether a line goes on as another. */
function goesOn(a, b) {
  const ends = [a.at(-2), a.at(-1), b[0], b[1]];
  const way = (from, to) => [to[0] - from[0], to[1] - from[1]];
  const [last, gap, first] = [way(ends[0], ends[1]), way(ends[1], ends[2]), way(ends[2], ends[3])];
  const reach = 1.6 * Math.max(Math.hypot(...last), Math.hypot(...first));
  if (Math.hypot(...gap) > reach || turn(last, first) > CORNER) return false;
  return Math.hypot(...gap) < 1e-6 * reach || turn(last, gap) < CORNER;
}

/** Contacts, those in a row together. */
async function contactSurfaces(run) {
  const pieces = await piecesOf(run);
  const after = pieces.map((piece) => pieces.findIndex((other) => other !== piece && goesOn(piece.places, other.places)));
  const made = [];
  const used = new Set();
  const chain = (first) => {
    const found = [];
    for (let k = first; k >= 0 && !used.has(k); k = after[k]) {
      used.add(k);
      found.push(pieces[k]);
    }
    const names = [...new Set(found.map(({ map }) => map.contact))];
    const name = names.length > 3 ? `${names[0]} to ${names.at(-1)} (${names.length} contacts)` : names.join(" + ");
    made.push(new ContactSurface(run, name, found, found.flatMap((piece) => piece.places)));
  };
  pieces.forEach((_, k) => after.includes(k) || chain(k));
  pieces.forEach((_, k) => used.has(k) || chain(k));
  return made.sort((a, b) => b.pieces.length - a.pieces.length);
}

/** Free sides of the bodies, from corner to corner. */
async function bodySurfaces(run) {
  const { solid } = run;
  if (!solid?.cells || !solid.frames.length) return [];
  const [places, connectivity, ends, kinds, bodies, history] = await Promise.all([unpack(solid.places), unpack(solid.connectivity, "u32"),
    unpack(solid.ends, "u32"), unpack(solid.kinds, "u8"), solid.body ? unpack(solid.body, "u32") : [], table(run.history)]);
  const edges = new Map();
  ends.forEach((_, e) => {
    const [start, ring] = [e ? ends[e - 1] : 0, RINGS[kinds[e]] || []];
    ring.forEach((k, i) => {
      const [a, b] = [connectivity[start + k], connectivity[start + ring[(i + 1) % ring.length]]];
      const key = Math.min(a, b) * solid.points + Math.max(a, b);
      edges.set(key, edges.has(key) ? null : { a, b, body: bodies[e] });
    });
  });
  const next = new Map([...edges.values()].filter(Boolean).map((edge) => [edge.a, edge]));
  const way = ({ a, b }) => [0, 1].map((i) => places[2 * b + i] - places[2 * a + i]);
  const before = new Map([...next.values()].map((edge) => [edge.b, edge]));
  const isCorner = (node) => !before.has(node) || !next.has(node) || turn(way(before.get(node)), way(next.get(node))) > CORNER;
  const used = new Set();
  const sides = [];
  const walk = (node) => {
    const found = [];
    for (let edge = next.get(node); edge && !used.has(edge); edge = isCorner(edge.b) ? null : next.get(edge.b)) {
      used.add(edge);
      found.push(edge);
    }
    if (found.length) sides.push(found);
  };
  [...next.keys()].filter(isCorner).forEach(walk);
  [...next.keys()].forEach(walk);
  const names = owners([{ history: history || { names: [] } }], "momentum_x");
  return named(sides, places, names, solid.origin).map(({ name, nodes }) => new BodySurface(run, name, nodes, places));
}

/** Sides with names: of which body, and which way they face; of several alike also where. */
function named(sides, places, names, origin) {
  const described = sides.map((edges) => {
    const nodes = [edges[0].a, ...edges.map(({ b }) => b)];
    const of = (node) => [0, 1].map((i) => places[2 * node + i]);
    let [length, n] = [0, [0, 0]];
    for (const { a, b } of edges) {
      const [dx, dy] = [0, 1].map((i) => of(b)[i] - of(a)[i]);
      length += Math.hypot(dx, dy);
      n = [n[0] + dy, n[1] - dx];
    }
    const [nx, ny] = n.map((part) => part / length);
    const faces = ny > 0.85 ? "top" : ny < -0.85 ? "bottom" : nx > 0.85 ? "right side" : nx < -0.85 ? "left side" : "side";
    const bodies = [...new Set(edges.map(({ body }) => names[body] ?? (body === undefined ? "" : `body ${body + 1}`)))];
    const middle = of(nodes[nodes.length >> 1]).map((x, i) => x + origin[i]);
    return { nodes, length, name: `${bodies.join(" + ")} ${faces}`.trim(), where: ` at (${middle.map((x) => told(x, 3)).join(", ")})` };
  });
  described.sort((a, b) => b.length - a.length);
  const several = (name) => described.filter((one) => one.name === name).length > 1;
  return described.slice(0, SIDES).map((one) => ({ ...one, name: several(one.name) ? one.name + one.where : one.name }));
}
