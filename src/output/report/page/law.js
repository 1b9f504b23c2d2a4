"use strict";
// A friction law driven alone: what it answered along its path of slip, pressure and time.

/** Holds that make an ageing curve. */
const FEWEST_HOLDS = 3;

/** Columns of law.csv that have charts of their own, or none. */
const OF_EVERY_LAW = ["time", "slip", "pressure", "traction", "R", "mu", "structure", "plastic_slip", "dissipation",
  "dtraction_dslip", "dtraction_dpressure", "evaluations"];

/** q/p over time between μ and, where the law is driven backwards, −μ; nothing where nothing is pressed. */
function coefficientChart(runs, x) {
  const drawn = runs.flatMap(({ run, k, history }) => {
    const [time, pressure, traction, mu] = ["time", "pressure", "traction", "mu"].map((name) => history.get(name));
    if (!pressure || !traction || !mu) return [];
    const ratio = traction.map((q, row) => (pressure[row] > 0 ? q / pressure[row] : NaN));
    const name = (what) => nameOf(what, run, 2);
    const { colour, dash } = look(k, 0, 1);
    const bound = (what, y) => ({ name: name(what), x: time, y, colour: several ? colour : styled("--soft"), dash: [3, 3], plain: true });
    const below = ratio.some((value) => value < 0) ? [bound("−μ", mu.map((value) => -value))] : [];
    return [{ name: name("q/p"), x: time, y: ratio, colour, dash }, bound("μ", mu), ...below];
  });
  return drawn.length ? new Chart({ title: "Friction coefficient over time", x, y: { label: "q/p, μ" }, series: drawn, time: true }) : null;
}

/** Peak friction after each hold over its duration: healing. */
function ageingChart(runs) {
  const drawn = runs.flatMap(({ run, k }) => {
    const holds = [...(run.summary.holds || [])].sort((a, b) => a.duration - b.duration);
    if (holds.length < FEWEST_HOLDS) return [];
    const [x, y] = [holds.map((hold) => hold.duration), holds.map((hold) => hold.peak.coefficient)];
    return [{ name: several ? labelOf(run) : "peak |q|/p", x, y, colour: curveColour(k), points: true }];
  });
  const x = { label: withUnit("hold duration", unitOf("time")), log: true };
  return drawn.length ? new Chart({ title: "Peak friction after a hold", x, y: { label: "peak |q|/p" }, series: drawn }) : null;
}

/** The law and its parameters in a line. */
function parameters(run) {
  const { law, ...values } = run.summary.friction?.law || {};
  if (!law) return null;
  const known = Object.entries(values).filter(([, value]) => value != null && typeof value !== "object");
  const line = known.map(([name, value]) => `${name} = ${typeof value === "number" ? told(value) : value}`).join(", ");
  return el("p", { class: "facts" }, `${several ? `${run.name}: ` : ""}${spoken(law)}: ${line}`);
}

async function showLaw() {
  const all = await Promise.all(DATA.runs.map(async (run, k) => ({ run, k, history: await table(run.law) })));
  const runs = all.filter(({ history }) => history && history.rows > 0);
  if (!runs.length) return;
  const [time, length, stress] = [timeAxis(), unitOf("length"), withUnit("traction q", unitOf("stress"))];
  const path = (title, name, label) => new Chart({ title, x: { label: withUnit(label, fieldUnit(name)) }, y: { label: stress },
    series: curves(runs, [["traction", "q"]], name), path: true });
  const varies = runs.some(({ history }) => history.get("pressure")?.some((value, _, all) => value !== all[0]));
  const further = [...new Set(runs.flatMap(({ history }) => history.names))].filter((name) => !OF_EVERY_LAW.includes(name));
  const charts = [
    path("Traction over slip", "slip", "slip"),
    coefficientChart(runs, time),
    overTime(runs, "Slip over time", [["slip", "total"], ["plastic_slip", "plastic"]], "slip", length),
    overTime(runs, "State over time", [["R", "R = |q|/(μ p)"], ["structure", "structure 1/R*"]], "R, structure", "", { include: [0] }),
    ...further.map((name) => overTime(runs, `${spoken(name)} over time`, [[name, spoken(name)]], spoken(name), fieldUnit(name))),
    varies ? overTime(runs, "Pressure over time", [["pressure", "p"]], "pressure p", unitOf("stress"), { include: [0] }) : null,
    varies ? path("Traction over pressure", "pressure", "pressure p") : null,
    ageingChart(runs),
    overTime(runs, "Dissipation", [["dissipation", "dissipation"]], "dissipation", fieldUnit("dissipation")),
  ];
  const section = document.getElementById("law");
  section.hidden = false;
  section.append(...runs.map(({ run }) => parameters(run)).filter(Boolean), ...grid(charts));
}
