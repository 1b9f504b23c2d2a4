"use strict";
// Histories of forces, displacements, slips and energies; convergence of Newton's method.

/** Dashes of the bounds of friction, the highest first. */
const BOUNDS = [[3, 3], [9, 4]];

/** Look of one of some columns of a run: of several runs, runs differ in colours and columns in dashes; where there is one column
 * only, runs differ in dashes, too, so that curves on top of each other are seen. */
function look(k, column, columns) {
  return several ? { colour: curveColour(k), dash: dash(columns > 1 ? column : k) } : { colour: curveColour(column), dash: dash(column) };
}

/** Name of a column of a run in legends. */
const nameOf = (label, run, columns) => (several ? (columns > 1 ? `${label} (${labelOf(run)})` : labelOf(run)) : label);

/** Curves of some columns of every run that has them. */
function curves(runs, columns, x = "time") {
  const drawn = [];
  columns.forEach(([name, label], column) => {
    for (const { run, k, history } of runs) {
      const [xs, ys] = [history.get(x), history.get(name)];
      if (!xs || !ys) continue;
      drawn.push({ name: nameOf(label, run, columns.length), x: xs, y: ys, ...look(k, column, columns.length) });
    }
  });
  return drawn;
}

const sizeOf = (series) => Math.max(0, ...series.map((one) => Math.max(...bounds(one.y).map(Math.abs))));

/** What stands before a dot and a column, in order. */
function owners(runs, column) {
  const all = runs.flatMap(({ history }) => history.names.filter((name) => name.endsWith(`.${column}`)));
  return [...new Set(all.map((name) => name.slice(0, -column.length - 1)))];
}

const ENERGIES = [
  ["external_work", "external work"], ["kinetic", "kinetic"], ["strain", "strain"], ["contact_elastic", "contact, elastic"],
  ["friction_dissipation", "friction"], ["damping_dissipation", "damping"], ["plastic_dissipation", "yielding"], ["radiated", "radiated"],
  ["plastic_dissipation", "plastic"],
];

/** Charts beside each other, and in a line below them what never changes; nothing if there is neither. */
function grid(made) {
  const [all, constants] = [made.filter((one) => one instanceof Chart), made.filter((one) => typeof one === "string")];
  const charts = all.length ? [el("div", { class: "grid" }, all.map((chart) => chart.element))] : [];
  return constants.length ? [...charts, el("p", { class: "facts" }, `Constant: ${constants.join("; ")}`)] : charts;
}

/** Charts under a heading; the first few stand open. */
function group(host, title, made, open) {
  const inside = grid(made);
  if (inside.length) host.append(el("details", { open }, el("summary", {}, title), ...inside));
}

function overTime(runs, title, columns, label, unit, more = {}) {
  const series = curves(runs, columns);
  if (!series.length || (!more.always && sizeOf(series) === 0)) return null;
  const [low, high] = bounds(series.flatMap((one) => bounds(one.y)));
  if (!more.always && series[0].x.length > 1 && high - low <= 1e-7 * sizeOf(series)) {
    return `${label} ${told(high)} ${unit}`.trim();
  }
  return new Chart({ title, x: timeAxis(), y: { label: withUnit(label, unit), ...more }, series, time: true });
}

/** A pair of directions; what is only round-off of the other one is left out. */
function directions(runs, set, names) {
  const sizes = names.map((name) => sizeOf(curves(runs, [[`${set}.${name}`, name]])));
  return names.filter((_, k) => sizes[k] > 1e-9 * Math.max(...sizes)).map((name) => [`${set}.${name}`, name]);
}

async function showHistories() {
  const section = document.getElementById("histories");
  const all = await Promise.all(DATA.runs.map(async (run, k) => ({ run, k, history: await table(run.history) })));
  const runs = all.filter(({ history }) => history && history.rows > 0);
  if (!runs.length) return runs;
  section.hidden = false;
  showPair(section, runs);
  const contacts = owners(runs, "normal_force");
  contacts.forEach((contact, k) => group(section, `Contact ${contact}`, contactCharts(runs, contact), k < 3));
  const sets = owners(runs, "ux");
  const watched = sets.flatMap((set) => [
    overTime(runs, `Displacement of ${set}`, directions(runs, set, ["ux", "uy"]), "mean displacement", unitOf("length")),
    overTime(runs, `Reaction of ${set}`, directions(runs, set, ["fx", "fy"]), "reaction", unitOf("force")),
  ]);
  group(section, "Watched sets", watched, sets.length < 6);
  group(section, "Bars", owners(runs, "axial_max").flatMap((bar) => barCharts(runs, bar)), true);
  group(section, "Energies", energyCharts(runs), true);
  return runs;
}

/** F_t/F_n over time, with the coefficients that bound it and, of one run, its largest size; where next to nothing presses it means nothing. */
function ratioChart(runs, contact, limits) {
  const [tangential, normal] = [`${contact}.tangential_force`, `${contact}.normal_force`];
  const pressed = runs.filter(({ history }) => history.get(tangential) && history.get(normal));
  const series = curves(pressed, [[tangential, "F_t/F_n"]]);
  series.forEach((one, k) => {
    const forces = pressed[k].history.get(normal);
    const least = 0.01 * Math.max(...bounds(forces).map(Math.abs));
    one.y = one.y.map((force, row) => (Math.abs(forces[row]) > least ? force / forces[row] : NaN));
  });
  const largest = sizeOf(series);
  if (!(largest > 0)) return null;
  const { x, y } = series[0];
  const peak = several ? "" : `: largest ${told(largest)} at t = ${timed(x[y.findIndex((ratio) => Math.abs(ratio) === largest)], 5)}${atLargestForce(pressed[0], tangential, y)}`;
  const backwards = series.some((one) => bounds(one.y)[0] < -0.25 * largest);
  const lines = limits.flatMap(([name, mu], k) => (backwards ? [1, -1] : [1]).map((sign) => (
    { name: `${sign < 0 ? "−" : ""}${name}`, x: [x[0], x[x.length - 1]], y: [sign * mu, sign * mu], colour: styled("--soft"), dash: BOUNDS[k % BOUNDS.length], plain: true })));
  return new Chart({ title: `F_t/F_n of ${contact}${peak}`, x: timeAxis(), y: { label: "tangential over normal force" }, series: [...series, ...lines], time: true });
}

/** F_t/F_n where F_t is largest, if that is at another time than the largest ratio. */
function atLargestForce({ history }, tangential, ratios) {
  const forces = Array.from(history.get(tangential), Math.abs);
  const ratio = Math.abs(ratios[forces.indexOf(Math.max(...forces))]);
  const text = told(ratio, 4);
  return Number.isFinite(ratio) && text !== told(sizeOf([{ y: ratios }]), 4) ? `; ${text} at the largest force` : "";
}

function contactCharts(runs, contact) {
  const of = (columns) => columns.map(([name, label]) => [`${contact}.${name}`, label]);
  const limits = DATA.runs.map((run) => run.bounds[contact]).find(Boolean) || [];
  const forces = curves(runs, of([["tangential_force", "tangential"]]));
  const { history } = runs.find((one) => one.history.get(`${contact}.normal_force`)) || runs[0];
  const normal = history.get(`${contact}.normal_force`);
  const backwards = forces.some((one) => bounds(one.y)[0] < -0.25 * sizeOf(forces));
  const grey = styled("--soft");
  const bound = (x, y, name, k) => ({ name, x, y, colour: grey, dash: BOUNDS[k % BOUNDS.length], plain: true });
  const path = curves(runs, of([["tangential_force", "friction"]]), `${contact}.normal_force`);
  const pressed = bounds(path.flatMap((one) => bounds(one.x)));
  const most = 1.05 * Math.max(0, pressed[1]);
  // Under a constant normal force it is a vertical line.
  const isPath = path.some((one) => sizeOf([one]) > 0) && pressed[1] - pressed[0] > 1e-7 * most;
  for (const [k, [name, mu]] of limits.entries()) {
    for (const sign of backwards ? [1, -1] : [1]) {
      const label = `${sign < 0 ? "−" : ""}${name} × normal force`;
      if (normal) forces.push(bound(history.get("time"), normal.map((force) => sign * mu * force), label, k));
      path.push(bound([0, most], [0, sign * mu * most], label, k));
    }
  }
  const force = unitOf("force");
  const rest = runs.flatMap((one) => one.history.names.filter((name) => name.startsWith(`${contact}.mean_`)));
  const observed = [...new Set(rest)].filter((name) => !/mean_(slip|elastic_slip)$/.test(name));
  return [
    new Chart({ title: `Friction in ${contact}`, x: timeAxis(), y: { label: withUnit("tangential force", force) }, series: forces, time: true }),
    ratioChart(runs, contact, limits),
    overTime(runs, `Normal force in ${contact}`, of([["normal_force", "normal"]]), "normal force", force),
    isPath && new Chart({ title: `Friction path of ${contact}`, x: { label: withUnit("normal force", force), include: [0] },
      y: { label: withUnit("tangential force", force), include: [0] }, series: path, path: true }),
    overTime(runs, `Slipping fraction of ${contact}`, of([["slip_fraction", "slipping fraction of the closed length"]]), "slipping fraction", "", { include: [0, 1], always: true }),
    overTime(runs, `Slip in ${contact}`, of([["mean_slip", "plastic slip"], ["mean_elastic_slip", "elastic slip"]]), "mean slip", unitOf("length")),
    overTime(runs, `Closed length of ${contact}`, of([["contact_length", "closed length"]]), "closed length", unitOf("length")),
    overTime(runs, `Penetration in ${contact}`, of([["max_penetration", "largest penetration"]]), "penetration", unitOf("length")),
    ...observed.map((name) => {
      const what = name.split(".mean_").pop();
      return overTime(runs, `Mean ${spoken(what)} in ${contact}`, [[name, spoken(what)]], spoken(what), fieldUnit(what));
    }),
  ];
}

/** All energies of one run in one chart; with several runs, one chart per energy. The energy error has its own. */
function energyCharts(runs) {
  const present = ENERGIES.filter((energy) => sizeOf(curves(runs, [energy])) > 0);
  const unit = unitOf("energy");
  const charts = several
    ? present.map((energy) => overTime(runs, `Energy: ${energy[1]}`, [energy], "energy", unit))
    : [present.length ? overTime(runs, "Energy balance", present, "energy", unit) : null];
  return [...charts, overTime(runs, "Energy error", [["energy_error", "error"]], "energy", unit)];
}

async function showConvergence(runs) {
  const section = document.getElementById("convergence");
  const steps = runs.filter(({ history }) => sizeOf([{ y: history.get("dt") || [] }]) > 0);
  const charts = [overTime(steps, "Length of the increments", [["dt", "Δt"]], "Δt", unitOf("time"), { log: true })];
  const attempts = [];
  for (const [k, run] of DATA.runs.entries()) {
    if (!run.newton) continue;
    const { newton } = run;
    const [residuals, solves] = await Promise.all([table(newton.residuals), table(newton.solves)]);
    const title = (text) => (several ? `${run.name}: ${text}` : text);
    const colour = curveColour(k);
    charts.push(new Chart({
      title: title("Linear solves per increment, with rejected attempts"), x: timeAxis(), y: { label: "linear solves", include: [0] },
      series: [{ name: "solves", x: solves.get("time"), y: solves.get("solves"), colour }], time: true,
    }));
    const what = newton.hardest < newton.increments ? `the ${newton.hardest} hardest of ${newton.increments} increments` : "every increment";
    charts.push(new Chart({
      title: title(`Residuals of ${what}`), x: { label: "iteration" }, y: { label: "relative residual", log: true },
      series: [{ name: "residual", x: residuals.get("iteration"), y: residuals.get("residual"), colour: `${colour}80`, plain: true }], path: true,
    }));
    if (newton.attempts?.total) attempts.push(givenUp(run, newton.attempts));
  }
  const drawn = charts.filter((one) => one instanceof Chart);
  if (!drawn.length) return;
  section.hidden = false;
  section.append(el("div", { class: "grid" }, drawn.map((chart) => chart.element)), ...attempts.flat());
}

/** Rejected attempts, with the reason of each. */
function givenUp(run, { given_up, total }) {
  const unit = unitOf("time");
  const more = given_up.length < total ? `, the first ${given_up.length} of which are listed` : "";
  const counts = Object.entries(run.summary.given_up || {});
  const causes = counts.sort((a, b) => b[1] - a[1]).map(([cause, count]) => el("li", {}, `${count} × ${cause}`));
  const columns = [
    ["t", (row) => row.time, withUnit("from t", unit)], ["dt", (row) => row.dt, withUnit("Δt", unit)], ["step", (row) => row.step, "step"],
    ["increment", (row) => row.increment, "increment"], ["attempt", (row) => row.attempt, "attempt"],
    ["iterations", (row) => row.iterations, "solves"], ["residual", (row) => row.residual, "last residual"],
    ["counts", (row) => row.counts.join(" / "), "open / stick / slip"], ["why", (row) => row.why, "reason"],
  ];
  return [
    el("h3", {}, `${several ? `${run.name}: ` : ""}${total} rejected attempt${total > 1 ? "s" : ""}${more}`),
    el("ul", {}, causes),
    tableOf(columns, given_up, (row) => now.set(row.time, "table")),
  ];
}
