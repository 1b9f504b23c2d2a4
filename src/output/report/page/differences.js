"use strict";
// By what runs on one page differ: keys of their cases, as they are written; names of runs in legends.

const several = DATA.runs.length > 1;

/** Keys that say how a case is called and what it writes, not what is computed. */
const NAMES = ["title", "units", "watch", "probes", "output"];

/** Differences that have room in a legend. */
const FEW = 3;

/** Values of a case by their places, such as `contacts.base.friction.mu_s`; parts of lists that have a name go by it. */
function leaves(value, place = "", found = new Map()) {
  if (value === null || typeof value !== "object") return found.set(place, value);
  for (const [key, part] of Object.entries(value)) {
    const name = Array.isArray(value) ? part?.name ?? (typeof part === "object" ? `${+key + 1}` : null) : key;
    if (name === null) return found.set(place, JSON.stringify(value));
    if (place || !NAMES.includes(name)) leaves(part, place ? `${place}.${name}` : name, found);
  }
  return found;
}

/** Places at which the cases of runs differ: [place, values of the runs]; those that a run leaves open are undefined. */
function differences(runs) {
  const cases = runs.map(({ summary }) => leaves(summary.given ?? { friction: summary.friction ?? {} }));
  const places = [...new Set(cases.flatMap((one) => [...one.keys()]))];
  const values = places.map((place) => [place, cases.map((one) => one.get(place))]);
  return values.filter(([, [first, ...others]]) => others.some((value) => value !== first));
}

/** So much of the end of each place as tells it from the others. */
function shortest(places) {
  const end = (place, count) => place.split(".").slice(-count).join(".");
  return places.map((place) => {
    const enough = (count) => places.every((other) => other === place || end(other, count) !== end(place, count));
    let count = 1;
    while (!enough(count) && count < place.split(".").length) count += 1;
    return end(place, count);
  });
}

const worth = (value) => (value === undefined ? "default" : typeof value === "number" ? told(value) : String(value));

const differing = several ? differences(DATA.runs) : [];

/** Names of runs in legends, with what they differ by, if that is little. */
const labels = (() => {
  const names = shortest(differing.map(([place]) => place));
  const few = differing.length > 0 && differing.length <= FEW;
  return DATA.runs.map((run, k) => (few
    ? `${run.name}: ${differing.map(([, values], i) => `${names[i]} = ${worth(values[k])}`).join(", ")}` : run.name));
})();
const labelOf = (run) => labels[DATA.runs.indexOf(run)];

/** A table of what the runs differ by; nothing of one run. */
function differencesTable() {
  if (!differing.length) return [];
  const most = 30;
  const rows = differing.slice(0, most).map(([place, values]) =>
    el("tr", {}, el("th", { scope: "row" }, place), values.map((value) => el("td", {}, worth(value)))));
  const head = el("tr", {}, el("th", { scope: "col" }, "differs"), DATA.runs.map((run) => el("th", { scope: "col" }, run.name)));
  const rest = differing.length > most ? [el("p", { class: "facts" }, `… and ${differing.length - most} more`)] : [];
  return [el("table", { class: "differences" }, el("thead", {}, head), el("tbody", {}, rows)), ...rest];
}
