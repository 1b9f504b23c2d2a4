"use strict";
// Status and warnings of the runs, what the page leaves out; the case as interpreted.

const STATUS = {
  completed: ["✓", "completed"], running: ["…", "running"], stopped: ["✕", "stopped"], interrupted: ["‖", "interrupted"],
  killed: ["✕", "ended without a status"], unknown: ["?", "end status unknown"],
};

/** How a run ended; one that still says it runs may have been killed. */
function statusOf(run) {
  const status = run.summary.status;
  if (status === "running" && !run.at_work) return "killed";
  return STATUS[status] ? status : "unknown";
}

function badge(run) {
  const status = statusOf(run);
  const [sign, text] = STATUS[status];
  return el("span", { class: `badge ${status}` }, `${sign} ${text}`);
}

/** A duration as it is read. */
function duration(seconds) {
  if (!Number.isFinite(seconds)) return "";
  if (seconds < 120) return `${told(seconds, 3)} s`;
  return seconds < 7200 ? `${told(seconds / 60, 3)} min` : `${told(seconds / 3600, 3)} h`;
}

/** Facts of a run in a line. */
function facts(run) {
  const { summary } = run;
  const count = (value, what) => (value > 0 ? `${value.toLocaleString("en")} ${what}${value === 1 ? "" : "s"}` : null);
  return [
    count(summary.elements, "element"), count(summary.point_masses, "point mass")?.replace("masss", "masses"),
    count(summary.dofs, "dof"), count(summary.contact_points, "contact point"), count(summary.increments, "increment"),
    count(summary.cutbacks, "cut-back"), count(summary.rejected, "rejection"),
    count(summary.newton_iterations, "linear solve"), count(summary.steps, "step"), peakOf(summary.peak), duration(summary.wall_s?.total),
    summary.peak_memory_mib ? `${told(summary.peak_memory_mib, 3)} MiB` : null,
  ].filter(Boolean);
}

/** The peak of a law driven alone. */
const peakOf = (peak) => (peak ? `peak |q|/p = ${told(peak.coefficient)} at t = ${told(peak.time)} ${unitOf("time")}`.trimEnd() : null);

const REASONS = {
  killed: "The summary says that the run is active, but no process of this computer writes to the folder any more: it was " +
    "killed, or runs on another computer. The results written until then are shown.",
  running: "The run is still active: this page shows what had been written when it was made. Make it again to see more.",
};

function runHead(run) {
  const { summary } = run;
  const reason = summary.reason || REASONS[statusOf(run)];
  const lines = [
    el("p", { class: "ending" }, badge(run), several ? el("strong", {}, " " + run.name) : null,
      reason ? el("span", { class: "reason" }, " " + reason) : null),
    el("p", { class: "facts" }, facts(run).join(" · ")),
  ];
  const warnings = summary.warnings || [];
  if (warnings.length) lines.push(listed(`${warnings.length} warning${warnings.length > 1 ? "s" : ""}`, warnings, "warnings"));
  return el("div", { class: "run" }, lines);
}

function listed(title, lines, kind) {
  return el("details", { class: kind, open: lines.length <= 8 }, el("summary", {}, title),
    el("ul", {}, lines.map((line) => el("li", {}, line))));
}

/** Look of the page: as the system has it, light, or dark. */
function themeButton() {
  const looks = { auto: "◐", light: "☀", dark: "☾" };
  const next = { auto: "light", light: "dark", dark: "auto" };
  let look = "auto";
  const toggle = button(looks.auto, "Light or dark", () => {
    look = next[look];
    toggle.textContent = looks[look];
    if (look === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = look;
    dispatchEvent(new Event("theme"));
  });
  toggle.classList.add("theme");
  return toggle;
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => dispatchEvent(new Event("theme")));
addEventListener("theme", () => charts.forEach((chart) => chart.redraw()));

function showHead() {
  const { runs } = DATA;
  const titles = [...new Set(runs.map((run) => run.summary.title || run.name))];
  document.title = `${titles.join(" · ")} – fecontact`;
  const cases = [...new Set(runs.map((run) => run.summary.case).filter(Boolean))];
  document.getElementById("head").replaceChildren(
    themeButton(),
    el("h1", {}, several && titles.length > 1 ? runs.map((run) => run.name).join(" · ") : titles[0]),
    el("p", { class: "case" }, cases.join(", ")),
    ...runs.map((run) => runHead(run)), ...differencesTable());
  const notes = runs.flatMap((run) => run.notes.map((note) => (several ? `${run.name}: ${note}` : note)));
  const faults = document.getElementById("faults");
  if (notes.length) {
    faults.append(listed(`Data left out of this page, and faults of the files (${notes.length})`, notes, "notes"));
    faults.hidden = false;
  }
  const version = runs.map((run) => run.summary.version).find(Boolean);
  document.getElementById("foot").replaceChildren(
    `fecontact ${version || DATA.version}. Charts: drag to zoom, double click for all; keys ← → read off, + − zoom, ` +
    "0 shows all. Bodies: drag to move, wheel or + − to zoom, ← → frames, space plays.");
}

/** The case as `check` tells it. */
function showCase() {
  const section = document.getElementById("case");
  for (const run of DATA.runs) {
    const understood = run.summary.understood || [];
    if (!understood.length) continue;
    const rows = understood.map(([heading, lines]) => el("tr", {}, el("th", { scope: "row" }, heading),
      el("td", {}, el("pre", {}, lines.join("\n")))));
    const body = el("table", { class: "case" }, el("tbody", {}, rows));
    section.append(el("details", { open: DATA.runs.length === 1 }, el("summary", {}, run.name), body));
    section.hidden = false;
  }
}
