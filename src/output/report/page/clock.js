"use strict";
// Times as they are read: of long runs in days or years instead of seconds.

/** Seconds of a Julian year. */
const YEAR = 31557600;

/** Unit of times on axes and in texts: its name, and how long it is in the unit of the case. Only seconds are converted. */
const clock = (() => {
  const longest = Math.max(0, ...DATA.runs.map((run) => run.until ?? 0));
  if (unitOf("time") !== "s") return { unit: unitOf("time"), size: 1 };
  if (longest >= 3 * YEAR) return { unit: "years", size: YEAR };
  return longest >= 5 * 86400 ? { unit: "days", size: 86400 } : { unit: "s", size: 1 };
})();

/** A time with its unit; in one that suits it, if it is short compared with that of the run. */
function timed(time, digits = 7) {
  const isShort = clock.size > 1 && time !== 0 && Math.abs(time) < 0.01 * clock.size;
  const [value, unit] = isShort ? spanned(time) : [time / clock.size, clock.unit];
  return `${told(value, digits)} ${unit}`.trimEnd();
}

/** A span of time in the unit in which it is read best, if times are in seconds: [number, unit]. */
function spanned(span) {
  if (unitOf("time") !== "s") return [span, unitOf("time")];
  const [size, unit] = [[YEAR, "years"], [86400, "days"], [3600, "h"]].find(([size]) => span >= 2 * size) || [1, "s"];
  return [span / size, unit];
}

/** Length of a unit of time in seconds. */
const lengthOf = (unit) => ({ years: YEAR, days: 86400, h: 3600 })[unit] || 1;

/** Axis of times. */
const timeAxis = () => ({ label: withUnit("time", clock.unit), size: clock.size });

/** Steps of a run, with their names and the times over which they last. */
function stepsOf(history) {
  const [names, times] = [history?.get("step"), history?.get("time")];
  if (!names || !times) return [];
  const steps = [];
  names.forEach((name, row) => {
    const last = steps.at(-1);
    if (last && last.name === name) last.to = times[row];
    else steps.push({ name, from: row ? times[row - 1] : times[0] - (history.get("dt")?.[0] || 0), to: times[row] });
  });
  return steps;
}

/** The step to which a time belongs: of a time at which one ends, that one. */
const stepAt = (steps, time) => steps.find(({ to }) => time <= to * (1 + 1e-12)) || steps.at(-1);
