// What report.html draws first for each field: force over displacement, profiles along surfaces, slip rates and cumulative slip, bars.
import { test } from "node:test";
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { PAGES, close, made, of, open } from "./common.mjs";

/** A table of a results folder by its columns. */
function columns(name, file) {
  const [head, ...rows] = readFileSync(join(PAGES, name, file), "utf8").trimEnd().split("\n").map((line) => line.split(","));
  return Object.fromEntries(head.map((column, k) => [column, rows.map((row) => row[k])]));
}

test("force over displacement is that of the driven support, and any column can be chosen", async () => {
  const page = await open(of("block_on_ground"));
  const drawn = () => page.evaluate(() => {
    const { x, y, series, title } = charts.find((one) => one.element.closest("#pair"));
    return { x: [...series[0].x], y: [...series[0].y], labels: [x.label, y.label], title };
  });
  const history = columns("block_on_ground", "history.csv");
  const single = (column) => history[column].map((value) => Math.fround(+value));
  const first = await drawn();
  assert.equal(first.title, "reaction x of block_top over displacement x of block_top");
  assert.deepEqual(first.labels, ["displacement x of block_top [mm]", "reaction x of block_top [N]"]);
  assert.deepEqual(first.x, single("block_top.ux"));
  assert.deepEqual(first.y, single("block_top.fx"));
  await page.locator("#pair select").nth(0).selectOption("base.tangential_force");
  await page.locator("#pair select").nth(1).selectOption("base.mean_slip");
  const other = await drawn();
  assert.deepEqual([other.x, other.y], [single("base.mean_slip"), single("base.tangential_force")]);
  await page.getByRole("button", { name: "Exchange the axes" }).click();
  assert.deepEqual((await drawn()).x, single("base.tangential_force"));
  await close(page);
});

test("a profile goes across the contacts of a wall, over depth, at the ends of the steps", async () => {
  const page = await open(of("anchored_wall"));
  const found = await page.evaluate(async () => {
    const { surface, surfaces, chart, axis, quantity, steps } = profilesView;
    const rows = [];
    for (const { map, first, last } of surface.pieces) {
      const packed = map.quantities.find((one) => one.name === "pressure");
      const [values, y] = await Promise.all([unpack(packed.chunk), unpack(map.places[1], "f64")]);
      for (let k = first; k <= last; k++) rows.push([values[(map.rows - 1) * map.points + k], y[k]]);
    }
    return { name: surface.name, names: surfaces.map((one) => one.name), axis, quantity: quantity.key, rows, steps: steps.map((one) => one.name),
      series: chart.series.map((one) => one.name), last: [...chart.series.at(-1).x].map((p, k) => [p, chart.series.at(-1).y[k]]), labels: [chart.x.label, chart.y.label] };
  });
  assert.equal(found.name, "inside to inside_1 (5 contacts)");
  assert.deepEqual([found.axis, found.quantity], ["y", "pressure"]);
  assert.deepEqual(found.labels, ["pressure p [kPa]", "y [m]"]);
  assert.deepEqual(found.last, found.rows);
  assert.deepEqual(found.series.map((name) => name.split(",")[0]), found.steps);
  assert.ok(["soil right side", "wall left side"].every((name) => found.names.includes(name)), found.names.join());
  // All of the curves are seen, the largest pressure among them.
  const [most, seen] = await page.evaluate(() => [Math.max(...profilesView.chart.series.flatMap((one) => [...one.x])), profilesView.chart.draw().plot.scales.x.max]);
  assert.ok(seen >= most, `${most} beyond ${seen}`);
  // Settlement of the ground: displacements of the nodes, as they stand in the frame of the bodies.
  const [settled, known] = await page.evaluate(async () => {
    await profilesView.open(profilesView.surfaces.find((one) => one.name.startsWith("soil top")));
    const { chart, surface } = profilesView;
    return [[...chart.series.at(-1).y], surface.nodes.map((node) => bodiesView.moved[2 * node + 1])];
  });
  assert.ok(Math.max(...known.map(Math.abs)) > 1e-4);
  assert.deepEqual(settled, known);
  assert.equal(await page.evaluate(() => profilesView.chart.y.label), "displacement y [m]");
  await close(page, "anchored_wall");
});

test("steps are named below the slider, and a click goes to the end of one", async () => {
  const page = await open(of("anchored_wall"));
  assert.deepEqual(await page.locator(".steps button").allInnerTexts(), ["rest", "1 m", "2 m", "anchor", "3 m", "4 m"]);
  await page.getByRole("button", { name: "Step anchor: to its end" }).click();
  await page.waitForFunction(() => bodiesView.clock.value.startsWith("anchor, t = 251 s"));
  assert.equal(await page.locator('.steps button[aria-current="true"]').innerText(), "anchor");
  await close(page);
});

test("bars are drawn with a diagram of a force, and are absent before they are built", async () => {
  const page = await open(of("anchored_wall"));
  const ink = (frame, bars) => page.evaluate(async ([frame, bars]) => {
    bodiesView.options.tractions = false;
    bodiesView.options.bars = bars;
    await bodiesView.show(frame);
    const { over } = bodiesView;
    return new Uint32Array(over.getContext("2d").getImageData(0, 0, over.width, over.height).data.buffer).filter(Boolean).length;
  }, [frame, bars]);
  const last = await page.evaluate(() => bodiesView.solid.frames.length - 1);
  const [without, lines, diagram] = [await ink(0, "axial_force"), await ink(last, ""), await ink(last, "axial_force")];
  assert.ok(lines > without + 300, `${lines} pixels with bars, ${without} without`);
  assert.ok(diagram > lines + 2000, `${diagram} pixels with the diagram, ${lines} with lines alone`);
  // The largest is that of the history.
  const { largest, value } = await page.evaluate(() => ({
    largest: Math.max(...peek(bodiesView.bars.frames.at(-1).fields.axial_force.components[0].chunk)),
    value: charts.find((one) => one.title === "Axial force of tendon").series[0].y.at(-1),
  }));
  assert.ok(Math.abs(largest - value) < 1e-3 * value, `${largest} in the picture, ${value} in the history`);
  await close(page);
});

test("cycles are read in years: slip rates, cumulative slip, profiles at intervals, and the time to the next event", async () => {
  const page = await open(of("fault"));
  const { onset } = columns("fault", "events.csv");
  assert.ok(onset.length >= 2);
  const drawn = await page.evaluate(() => Object.fromEntries(charts.filter((one) => one.series.length).map(({ title, x, y, series }) => (
    [title, { x: x.label, y: y.label, log: [Boolean(x.log), Boolean(y.log)], reverse: Boolean(x.reverse), first: [...series[0].x].slice(0, 3), count: series.length }]))));
  assert.equal(drawn["Friction in fault"].x, "time [years]");
  const rates = drawn["Largest slip rate of fault"];
  assert.deepEqual([rates.x, rates.y, rates.log], ["time [years]", "largest slip rate [m/s]", [false, true]]);
  const before = drawn["Largest slip rate of fault before its events"];
  assert.deepEqual([before.x, before.log, before.reverse, before.count], ["time to the event [s]", [true, true], true, onset.length]);
  // The first of its points is the last time before the event that the store has.
  assert.ok(before.first[0] > 0 && before.first[0] < 60, before.first.join());
  assert.equal(drawn["Cumulative slip of fault"].count, 2);
  // Profiles every two years between events, every second in them, at rows of the store.
  const { mode, every, rows, fast } = await page.evaluate(() => ({ mode: profilesView.mode, every: profilesView.every, rows: profilesView.chart.series.length,
    fast: profilesView.chart.series.filter((one) => one.name.startsWith("event")).length }));
  assert.deepEqual([mode, every], ["every", 2]);
  assert.ok(fast > 10 && rows - fast > 15, `${fast} of ${rows} profiles in events`);
  // Onsets in the table are in years, durations in seconds.
  const headings = await page.locator("#events thead th").allInnerTexts();
  assert.ok(headings.includes("onset [years]") && headings.includes("duration [s]"), headings.join());
  const cells = await page.locator("#events tbody tr").first().locator("td").allInnerTexts();
  assert.ok(Math.abs(+cells[2] - onset[0] / 31557600) < 1e-4, cells.join());
  await close(page, "fault");
});

test("a friction path is drawn where the normal force changes, and fills its chart", async () => {
  const fault = await open(of("fault"));
  assert.equal(await fault.evaluate(() => charts.filter((one) => one.title.startsWith("Friction path")).length), 0);
  await close(fault);
  const page = await open(of("block_on_ground"));
  const [low, high, seen] = await page.evaluate(() => {
    const chart = charts.find((one) => one.title.startsWith("Friction path")).draw();
    const { min, max } = chart.plot.scales.y;
    return [...bounds(chart.series[0].y), max - min];
  });
  assert.ok(high - low > 0.5 * seen, `${high - low} of ${seen}`);
  await close(page);
});

test("events that set out again from where one has just been are one", async () => {
  const page = await open(of("fault"));
  const counted = await page.evaluate(() => {
    const of = (rows) => {
      const names = ["contact", "onset", "duration", "position", "length"];
      return nucleations({ rows: rows.length, get: (name) => rows.map((row) => row[names.indexOf(name)]) });
    };
    return [
      of([["a", 0, 1, 5, 2], ["a", 1.5, 3, 6, 4], ["a", 100, 1, 5, 2]]),
      of([["a", 0, 1, 5, 2], ["a", 1.5, 3, 9, 4]]),
      of([["a", 0, 1, 5, 2], ["b", 1.5, 3, 5, 4]]),
    ];
  });
  assert.deepEqual(counted, [[0, 2], [0, 1], [0, 1]]);
  await close(page);
});

test("legends have values only while something is pointed at", async () => {
  const page = await open(of("tube"));
  const chart = page.locator("#histories figure.chart").nth(1);
  await chart.scrollIntoViewIfNeeded();
  const values = () => chart.locator(".u-legend").innerText();
  assert.ok(!/[:–]/.test(await values()), await values());
  const over = await chart.locator(".u-over").boundingBox();
  await page.mouse.move(over.x + 0.5 * over.width, over.y + 0.5 * over.height);
  assert.match(await values(), /time \[[^\]]+\]:?\s*\d/);
  await page.mouse.move(2, 2);
  assert.ok(!/\d\.\d/.test(await values()), await values());
  await close(page);
});

test("the largest ratio and the ratio at the largest force are named apart", async () => {
  const page = await open(of("block_on_ground"));
  const history = columns("block_on_ground", "history.csv");
  const [force, normal] = ["tangential_force", "normal_force"].map((name) => history[`base.${name}`].map(Number));
  const ratios = force.map((q, k) => Math.abs(q / normal[k])).filter((_, k) => normal[k] > 0.01 * Math.max(...normal));
  const peak = force.map(Math.abs).indexOf(Math.max(...force.map(Math.abs)));
  const title = await page.evaluate(() => charts.find((one) => one.title.startsWith("F_t/F_n")).title);
  const [, largest, there] = title.match(/largest ([\d.]+) at t = [\d.]+ s; ([\d.]+) at the largest force/) || [];
  assert.ok(Math.abs(+largest - Math.max(...ratios)) < 1e-5, title);
  assert.ok(Math.abs(+there - Math.abs(force[peak] / normal[peak])) < 1e-4, title);
  await close(page);
});

test("without WebGL no background shows between elements", async () => {
  const other = await chromium.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu", "--disable-webgl", "--disable-webgl2", "--disable-3d-apis"] });
  const page = await other.newPage();
  await page.goto(`file://${made("elements_20000")}`);
  await page.waitForSelector("html[data-ready]", { state: "attached" });
  const pale = await page.evaluate(() => {
    bodiesView.options.edges = false;
    bodiesView.draw();
    const { canvas } = bodiesView;
    const [w, h] = [canvas.width, canvas.height];
    const middle = canvas.getContext("2d").getImageData(Math.round(0.4 * w), Math.round(0.4 * h), Math.round(0.2 * w), Math.round(0.2 * h)).data;
    return [bodiesView.scene.constructor.name, middle.filter((value, k) => k % 4 === 3 && value < 255).length];
  });
  assert.deepEqual(pale, ["PlainScene", 0]);
  await other.close();
});
