"use strict";
// Any history over any other: at first the force of the driven support over its displacement.

/** A column of a table in words, with what it belongs to. */
function inWords(name) {
  const dot = name.lastIndexOf(".");
  const what = DIRECTIONS[name.slice(dot + 1)] || spoken(name.slice(dot + 1));
  return dot < 0 ? what : `${what} of ${name.slice(0, dot)}`;
}
const DIRECTIONS = { ux: "displacement x", uy: "displacement y", fx: "reaction x", fy: "reaction y" };
const withItsUnit = (name) => (name === "time" ? timeAxis().label : withUnit(inWords(name), fieldUnit(name.slice(name.lastIndexOf(".") + 1))));

/** Whether a support is told to move. */
function isDriven(motion) {
  if (motion === null || motion === undefined || motion === 0) return false;
  if (typeof motion !== "object") return true;
  return Array.isArray(motion) ? motion.some((part) => isDriven(part?.[1] ?? part)) : Object.values(motion).some((part) => part !== 0);
}

/** Work of a force along a displacement, back and forth alike. */
function worked(history, [x, y]) {
  const [u, f] = [history.get(x), history.get(y)];
  let sum = 0;
  for (let k = 1; u && f && k < u.length; k++) sum += Math.abs((u[k] - u[k - 1]) * (f[k] + f[k - 1]));
  return Number.isFinite(sum) ? sum : 0;
}

/** Displacement and reaction of the support that is driven last; of contacts, if none is watched, friction and slip. */
function defaultPair({ run, history }) {
  const pair = (on, axis) => [`${on}.u${axis}`, `${on}.f${axis}`];
  const known = ([x, y]) => history.get(x) && history.get(y) && worked(history, [x, y]) > 0;
  const best = (pairs) => pairs.filter(known).sort((a, b) => worked(history, b) - worked(history, a))[0];
  for (const step of [...(run.summary.given?.steps || [])].reverse()) {
    const pairs = (step.supports || []).flatMap((support) => ["x", "y"].filter((axis) => isDriven(support[`u${axis}`]))
      .flatMap((axis) => [support.on].flat().map((on) => pair(on, axis))));
    if (best(pairs)) return best(pairs);
  }
  const watched = history.names.filter((name) => /\.ux$/.test(name)).map((name) => name.slice(0, -3));
  const contacts = history.names.filter((name) => /\.tangential_force$/.test(name)).map((name) => name.slice(0, -17));
  return best(watched.flatMap((on) => [pair(on, "x"), pair(on, "y")])) ||
    best(contacts.map((contact) => [`${contact}.mean_slip`, `${contact}.tangential_force`])) || ["time", "external_work"];
}

function showPair(section, runs) {
  const columns = [...new Set(runs.flatMap(({ history }) => history.names))].filter((name) => name === "time" ||
    runs.some(({ history }) => typeof history.get(name)?.[0] === "number" && bounds(history.get(name)).some((value) => value !== 0)));
  const options = columns.map((name) => [name, inWords(name)]);
  let [x, y] = defaultPair(runs[0]);
  if (![x, y].every((name) => columns.includes(name))) return;
  const chart = new Chart({ title: "", x: { label: "" }, y: { label: "" }, series: [], path: true, height: 300 });
  const show = () => {
    const axis = x === "time" ? timeAxis() : { label: withItsUnit(x) };
    chart.set(curves(runs, [[y, inWords(y)]], x), `${inWords(y)} over ${inWords(x)}`, { label: withItsUnit(y) }, axis);
    for (const [label, value] of [[first, x], [second, y]]) label.select.value = value;
  };
  const [second, first] = [choice("upwards", options, y, (name) => ((y = name), show())), choice("over", options, x, (name) => ((x = name), show()))];
  section.append(el("div", { class: "pair", id: "pair" }, el("div", { class: "controls" }, second, first,
    button("⇄", "Exchange the axes", () => (([x, y] = [y, x]), show()))), chart.element));
  show();
}
