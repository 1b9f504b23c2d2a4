// report.html in Chromium: opened from file://, looked at, clicked, zoomed, exported; with faults in its folder; measured.
import { test } from "node:test";
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { PAGES, PROGRAM, close, made, of, open, picture, text } from "./common.mjs";

for (const name of ["block_on_ground", "tube", "slip_front", "spring_mass_3", "stopped"]) {
  test(`${name} opens from a file, without errors and without a network, below 30 MB`, async () => {
    assert.ok(statSync(of(name)).size < 30e6);
    const page = await open(of(name));
    const summary = JSON.parse(readFileSync(join(PAGES, name, "summary.json"), "utf8"));
    assert.equal(await text(page, "h1"), summary.title);
    assert.match(await text(page, ".badge"), new RegExp(summary.status));
    if (summary.reason) assert.ok((await text(page, "#head")).includes(summary.reason));
    for (const warning of summary.warnings) assert.ok((await page.locator("#head").textContent()).includes(warning));
    // The case as `check` tells it, the materials among it.
    const told = await page.locator("#case").textContent();
    for (const [heading, lines] of summary.understood) for (const line of [heading, ...lines]) assert.ok(told.includes(line), line);
    await close(page, name);
  });
}

test("the first case has a page of at most 4 MB in a folder of at most 20 MB, and the page says what it leaves out", async () => {
  const size = (folder) => readdirSync(folder, { withFileTypes: true }).reduce((sum, entry) => {
    const path = join(folder, entry.name);
    return sum + (entry.isDirectory() ? size(path) : statSync(path).size);
  }, 0);
  const [page_size, all] = [statSync(of("block_on_ground")).size, size(join(PAGES, "block_on_ground"))];
  console.log(`block_on_ground: page ${(page_size / 1e6).toFixed(1)} MB, folder ${(all / 1e6).toFixed(1)} MB`);
  assert.ok(page_size <= 4e6 && all <= 20e6);
  const page = await open(of("block_on_ground"));
  // Half a step of 2^-13, as a percentage.
  assert.match(await text(page, "#bodies"), /Values are shown to 0\.006 % of the largest in each frame/);
  // What is shown is what the file holds, to the error that is told.
  const [range, shown] = await page.evaluate(() => {
    const { range } = bodiesView.solid.frames.at(-1).fields.von_mises.components[0];
    return [range, bounds(bodiesView.values)];
  });
  range.forEach((value, k) => assert.ok(Math.abs(value - shown[k]) <= range[1] / 16000, `${shown} of ${range}`));
  await close(page);
});

test("all charts are there when the page is ready, whoever looks, and on paper", async () => {
  for (const name of ["slip_front", "block_on_ground"]) {
    const page = await open(of(name));
    const [all, blank] = await page.evaluate(() => {
      const seen = charts.filter((chart) => chart.series.length && chart.host.clientWidth);
      const inked = ({ plot }) => {
        const { canvas } = plot.ctx;
        return new Set(new Uint32Array(plot.ctx.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size > 10;
      };
      return [seen.length, seen.filter((chart) => !chart.plot || !inked(chart)).map((chart) => chart.title)];
    });
    assert.ok(all > 10, `${all} charts`);
    assert.deepEqual(blank, []);
    await page.evaluate(() => addEventListener("beforeprint", () => (document.body.dataset.widths = charts.filter((one) => one.plot).map((one) => one.plot.width))));
    await page.pdf({ format: "A4" });
    const widths = (await page.evaluate(() => document.body.dataset.widths)).split(",");
    // Two beside each other on 210 mm, at 96 pixels an inch, but for its margins.
    assert.ok(widths.length === all && widths.every((width) => 2 * width < (210 / 25.4) * 96 - 76), widths.join());
    assert.ok(await page.evaluate(() => charts.every((one) => !one.plot || one.plot.width === one.width())), "they are as before");
    await close(page);
  }
});

test("no title and no label is clipped, on the page and in a picture that is saved", async () => {
  for (const [name, width] of [["slip_front", 1280], ["block_on_ground", 400]]) {
    const page = await open(of(name), { viewport: { width, height: 900 } });
    const clipped = await page.evaluate(async () => {
      const found = [];
      const [first] = charts;
      first.set(first.series, "a long title ".repeat(12).trim(), { ...first.y, label: "a label that is longer than its axis is high [mm]" });
      await new Promise((done) => setTimeout(done));
      for (const chart of charts.filter((one) => one.plot)) {
        const caption = chart.element.querySelector("figcaption");
        if (caption.scrollWidth > caption.clientWidth + 1) found.push(`caption ${chart.title}`);
        const host = el("div", { style: "position: absolute; left: 0; top: 0" });
        host.innerHTML = svg(chart);
        document.body.append(host);
        const frame = host.firstChild.getBoundingClientRect();
        for (const text of host.querySelectorAll("text")) {
          const box = text.getBoundingClientRect();
          const out = box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1;
          if (out) found.push(`${chart.title}: ${text.textContent}`);
        }
        host.remove();
      }
      return found;
    });
    assert.deepEqual(clipped, []);
    await close(page);
  }
});

test("the slider moves the mesh, and play goes on", async () => {
  const page = await open(of("tube"));
  const slider = page.locator("#bodies input[type=range]");
  const set = async (frame) => {
    await slider.evaluate((input, value) => {
      input.value = value;
      input.dispatchEvent(new Event("input"));
    }, frame);
    await page.waitForFunction((value) => bodiesView.frame === value, frame);
  };
  await set(0);
  const first = await picture(page, "#bodies .stage canvas:first-child");
  await set(50);
  assert.notEqual(await picture(page, "#bodies .stage canvas:first-child"), first);
  // What is drawn is what stands in the frame: |u| of the largest displacement, as the page's own reader is told by the file.
  const largest = await page.evaluate(() => Math.max(...bodiesView.moved.map(Math.abs)));
  assert.ok(largest > 0);
  await page.locator("#bodies .stage").press("ArrowRight");
  await page.waitForFunction(() => bodiesView.frame === 51);
  await page.locator("#bodies .stage").press("Home");
  await page.waitForFunction(() => bodiesView.frame === 0);
  await page.getByRole("button", { name: "Play" }).first().click();
  await page.waitForFunction(() => bodiesView.frame > 2);
  await close(page);
});

test("every field is drawn, in every map, enlarged, with and without edges", async () => {
  const page = await open(of("tube"));
  const keys = await page.evaluate(() => bodiesView.fields.map((field) => field.key));
  assert.ok(["displacement.size", "von_mises.0", "stress.3", "body.id"].every((key) => keys.includes(key)), keys.join());
  const seen = new Set();
  for (const key of keys) {
    await page.locator("#bodies select").first().selectOption(key);
    await page.waitForFunction((wanted) => bodiesView.field.key === wanted && bodiesView.values.length > 0, key);
    seen.add(await picture(page, "#bodies .stage canvas:first-child"));
  }
  assert.ok(seen.size > keys.length / 2);
  const range = await page.evaluate(() => bodiesView.range());
  assert.ok(range[1] > range[0]);
  await page.getByLabel("scale of displacement").fill("3");
  await page.getByLabel("scale of displacement").press("Tab");
  assert.equal(await page.evaluate(() => bodiesView.scale), 3);
  for (const box of ["elements", "tractions"]) {
    const before = await picture(page, `#bodies .stage canvas:${box === "elements" ? "first" : "last"}-child`);
    await page.getByLabel(box).click();
    assert.notEqual(await picture(page, `#bodies .stage canvas:${box === "elements" ? "first" : "last"}-child`), before, box);
  }
  await close(page);
});

test("a click into the interface chooses a profile and a history", async () => {
  const page = await open(of("block_on_ground"));
  const view = page.locator("#interface .map");
  await view.scrollIntoViewIfNeeded();
  const titles = () => page.locator("#interface figcaption > span:first-child").allInnerTexts();
  const before = await titles();
  const box = await view.boundingBox();
  await view.click({ position: { x: 0.4 * box.width, y: 0.6 * box.height } });
  await page.waitForFunction((old) => document.querySelector("#interface figcaption > span").innerText !== old, before[0]);
  assert.notDeepEqual(await titles(), before);
  // The profile is the row of the map at the chosen time, as contact/*.vtu has it.
  const [values, expected] = await page.evaluate(() => {
    const { values, chosen, places, profile, quantity } = interfaceView;
    const shown = profile.series.find((one) => one.name === spoken(quantity.name));
    return [Array.from(shown.y), Array.from(values.subarray(chosen.row * places.length, (chosen.row + 1) * places.length))];
  });
  assert.deepEqual(values, expected);
  const row = await page.evaluate(() => interfaceView.chosen.row);
  await view.press("ArrowUp");
  assert.equal(await page.evaluate(() => interfaceView.chosen.row), row + 1);
  await close(page);
});

test("charts zoom by the mouse and by keys, are read off, and are saved as SVG and CSV", async () => {
  const page = await open(of("tube"));
  const chart = page.locator("#histories details figure.chart").first();
  await chart.scrollIntoViewIfNeeded();
  await page.waitForFunction(() => charts.find((one) => one.host.closest("#histories details")).plot);
  const span = () => page.evaluate(() => {
    const { min, max } = charts.find((one) => one.host.closest("#histories details")).plot.scales.x;
    return max - min;
  });
  const whole = await span();
  const over = await chart.locator(".u-over").boundingBox();
  await page.mouse.move(over.x + 0.3 * over.width, over.y + 0.5 * over.height);
  await page.mouse.down();
  await page.mouse.move(over.x + 0.6 * over.width, over.y + 0.5 * over.height, { steps: 5 });
  await page.mouse.up();
  const zoomed = await span();
  assert.ok(Math.abs(zoomed / whole - 0.3) < 0.03, `${zoomed} of ${whole}`);
  await chart.locator(".plot").press("0");
  assert.ok(Math.abs(await span() - whole) < 1e-6 * whole);
  await chart.locator(".plot").press("+");
  assert.ok((await span()) < 0.6 * whole);
  await chart.locator(".plot").press("0");
  await chart.locator(".plot").press("Home");
  await chart.locator(".plot").press("ArrowRight");
  assert.match(await chart.locator(".u-legend .u-value").first().innerText(), /\d/);
  const svg = (await saved(page, chart, "SVG")).toString();
  assert.match(svg, /^<svg[^]*<path d="M[^"]{40,}"[^]*<\/svg>\s*$/);
  assert.ok(svg.includes("tangential force"));
  // The data are those of history.csv, to single precision.
  const rows = (await saved(page, chart, "CSV")).toString().trimEnd().split("\n").map((line) => line.split(","));
  const history = readFileSync(join(PAGES, "tube", "history.csv"), "utf8").trimEnd().split("\n").map((line) => line.split(","));
  const column = history[0].indexOf("bar.tangential_force");
  assert.equal(rows.length, history.length);
  rows.slice(1).forEach((row, k) => {
    assert.equal(+row[0], +history[k + 1][0]);
    assert.equal(Math.fround(+row[1]), Math.fround(+history[k + 1][column]));
  });
  await close(page);
});

test("an event of the table is shown close up, with its fronts, at its time", async () => {
  const page = await open(of("slip_front"));
  await page.locator("#events tbody tr").first().click();
  await page.waitForTimeout(500);
  const [window, onset, time] = await page.evaluate(() => [interfaceView.window.t, +interfaceView.times[interfaceView.chosen.row], now.time]);
  const fronts = readFileSync(join(PAGES, "slip_front", "fronts.csv"), "utf8").trimEnd().split("\n").slice(1).map((line) => line.split(","));
  const first = Math.min(...fronts.filter((row) => row[11] === "1").map((row) => +row[6]));
  // The table has the numbers of the file, and their units.
  const [head, ...events] = readFileSync(join(PAGES, "slip_front", "events.csv"), "utf8").trimEnd().split("\n").map((line) => line.split(","));
  const headings = await page.locator("#events thead th").allInnerTexts();
  assert.equal(headings.length, head.length);
  for (const [name, heading] of [["onset", /\[s\]$/], ["peak_slip_rate", /\[mm\/s\]$/], ["stress_drop", /\[N\/mm²\]$/], ["length", /\[mm\]$/]]) {
    assert.match(headings[head.indexOf(name)], heading);
  }
  const cells = await page.locator("#events tbody tr").first().locator("td").allInnerTexts();
  const number = (text) => +text.replace("−", "-").replace("−", "-");
  for (const name of ["onset", "length", "stress_drop"]) {
    const [shown, known] = [number(cells[head.indexOf(name)]), +events[0][head.indexOf(name)]];
    assert.ok(Math.abs(shown - known) <= 1e-5 * Math.abs(known), `${name}: ${shown} of ${known}`);
  }
  // Fronts are drawn where they passed: without them it is another picture.
  const drawn = await page.evaluate(() => {
    const { canvas, settings } = interfaceView;
    const white = () => {
      const colours = new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer);
      return colours.reduce((count, colour) => count + (colour === 0xffffffff ? 1 : 0), 0);
    };
    const counts = [true, false].map((fronts) => {
      settings.fronts = fronts;
      interfaceView.draw();
      return white();
    });
    settings.fronts = true;
    interfaceView.draw();
    return counts;
  });
  assert.ok(drawn[0] > drawn[1] + 30, `${drawn} white pixels with and without fronts`);
  assert.ok(window[0] < first && first < window[1] && window[1] - window[0] < 0.01, `${window} about ${first}`);
  assert.ok(Math.abs(time - first) < 1e-9 && Math.abs(onset - first) < 1e-4);
  await close(page, "slip_front_event");
});

test("of a run without a table of events they are those that the slip rates tell", async () => {
  const page = await open(made("no_fronts"));
  assert.match(await page.locator("#events h3").innerText(), /by the slip rates/);
  const shown = await page.locator("#events tbody tr").evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.innerText)));
  const known = readFileSync(join(PAGES, "slip_front", "events.csv"), "utf8").trimEnd().split("\n").map((line) => line.split(","));
  const column = (name) => known[0].indexOf(name);
  // Those of events.csv that slipped more than a little, at their onsets.
  const largest = Math.max(...known.slice(1).map((row) => Math.abs(+row[column("mean_slip")])));
  for (const row of known.slice(1).filter((row) => Math.abs(+row[column("mean_slip")]) > 0.1 * largest)) {
    const near = shown.map((cells) => Math.abs(+cells[1] - +row[column("onset")]));
    assert.ok(Math.min(...near) < 1e-4, `${row[column("onset")]} is not among ${shown.map((cells) => cells[1])}`);
  }
  await page.locator("#events tbody tr").first().click();
  await page.waitForFunction(() => interfaceView.window.t[1] - interfaceView.window.t[0] < 0.01);
  await close(page, "no_fronts");
});

test("snapshots are rows of the interface at times of the picture, and follow it", async () => {
  const page = await open(of("block_on_ground"));
  const drawn = () => page.evaluate(() => {
    const { snapshots, values, places, times } = interfaceView;
    return snapshots.series.filter((one) => !one.unlisted).map((one) => {
      const row = times.findIndex((time) => one.name === `t = ${told(time, 7)} s`);
      return { row, same: Array.from(one.y).every((value, k) => value === values[row * places.length + k]) };
    });
  });
  const before = await drawn();
  assert.ok(before.length === 6 && before.every(({ same }) => same), JSON.stringify(before));
  assert.deepEqual([before[0].row, before[5].row], [0, await page.evaluate(() => interfaceView.times.length - 1)]);
  await page.getByRole("button", { name: "Zoom in at the chosen time and place" }).click();
  await page.waitForFunction((row) => !interfaceView.snapshots.series[0].name.endsWith(`= ${told(interfaceView.times[row], 7)} s`), before[0].row);
  assert.ok((await drawn()).every(({ same }) => same));
  await close(page);
});

/** What a button saves. */
async function saved(page, place, kind) {
  const [download] = await Promise.all([page.waitForEvent("download"), place.getByText(kind, { exact: true }).click()]);
  return readFileSync(await download.path());
}

/** Whether a browser can read a picture, and of how many colours it is. */
const colours = (page, bytes, type) => page.evaluate(async ([text, type]) => {
  const picture = new Image();
  picture.src = `data:${type};base64,${text}`;
  await picture.decode();
  const canvas = el("canvas", { width: picture.width, height: picture.height });
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  return new Set(new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
}, [bytes.toString("base64"), type]);

test("every picture is saved as SVG, PNG and CSV", async () => {
  const page = await open(of("block_on_ground"));
  await page.evaluate(() => charts.forEach((chart) => chart.draw()));
  const histories = page.locator("#histories details figure.chart").first();
  for (const [place, least, words] of [[page.locator("#bodies"), 100, "von Mises"], [page.locator("#interface > .controls"), 100, "position along"],
    [histories, 3, "tangential force"]]) {
    const svg = await saved(page, place, "SVG");
    assert.ok(svg.toString().includes(words) && /^<svg[^]*<\/svg>\s*$/.test(svg.toString()), words);
    assert.ok(await colours(page, svg, "image/svg+xml") >= least, words);
    assert.ok(await colours(page, await saved(page, place, "PNG"), "image/png") >= least, words);
    assert.ok((await saved(page, place, "CSV")).toString().split("\n").length > 20, words);
  }
  // The bodies as they stand in the frame.
  const rows = (await saved(page, page.locator("#bodies"), "CSV")).toString().trimEnd().split("\n").map((line) => line.split(","));
  assert.equal(rows.length - 1, await page.evaluate(() => bodiesView.solid.points));
  assert.deepEqual(rows.slice(1).map((row) => +row[4]), await page.evaluate(() => Array.from(bodiesView.values)));
  await close(page);
});

test("charts turn logarithmic and back, and curves that are no functions are zoomed along x", async () => {
  const page = await open(of("block_on_ground"));
  const chart = (title) => page.locator("figure.chart").filter({ hasText: title }).first();
  const scale = (title, axis) => page.evaluate(([title, axis]) => {
    const { min, max, distr } = charts.find((one) => one.title.startsWith(title)).plot.scales[axis];
    return { min, max, distr };
  }, [title, axis]);
  await page.evaluate(() => charts.forEach((chart) => chart.draw()));
  const [turned, path] = ["Energy balance", "Friction path"];
  await chart(turned).getByText("log", { exact: true }).click();
  assert.equal((await scale(turned, "y")).distr, 3);
  await chart(turned).getByText("log", { exact: true }).click();
  assert.notEqual((await scale(turned, "y")).distr, 3);
  // What is chosen stays when other curves are shown.
  await page.evaluate(() => interfaceView.history.turn());
  await page.locator("#interface .map").press("ArrowLeft");
  await page.waitForFunction(() => interfaceView.history.title.includes(told(interfaceView.places[interfaceView.chosen.point])));
  assert.equal(await page.evaluate(() => interfaceView.history.draw().plot.scales.y.distr), 3);
  assert.equal((await scale("Residuals", "y")).distr, 3);
  const residuals = await scale("Residuals", "y");
  assert.ok(residuals.min <= 1e-9 && residuals.max >= 1e-2, JSON.stringify(residuals));
  const whole = await scale(path, "x");
  await chart(path).locator(".plot").press("+");
  const zoomed = await scale(path, "x");
  assert.ok(zoomed.max - zoomed.min < 0.6 * (whole.max - whole.min), JSON.stringify([whole, zoomed]));
  await chart(path).locator(".plot").press("0");
  assert.deepEqual(await scale(path, "x"), whole);
  await close(page);
});

test("a law driven alone is shown", async () => {
  const page = await open(of("hold_slide_hold"));
  const titles = () => page.locator("#law figcaption > span:first-child").allInnerTexts();
  for (const title of ["Traction over slip", "Friction coefficient over time", "Slip over time", "State over time", "Peak friction after a hold"]) {
    assert.ok((await titles()).includes(title), title);
  }
  assert.ok(!(await titles()).includes("Pressure over time"));
  assert.match(await page.locator("#law").innerText(), /super subloading: .*mu_s = 0\.6/);
  const { holds } = JSON.parse(readFileSync(join(PAGES, "hold_slide_hold", "summary.json"), "utf8"));
  const ageing = await page.evaluate(() => {
    const chart = charts.find((one) => one.title.startsWith("Peak friction")).draw();
    return { y: chart.series[0].y, distr: chart.plot.scales.x.distr };
  });
  assert.deepEqual(ageing, { y: holds.map((hold) => hold.peak.coefficient), distr: 3 });
  await close(page, "hold_slide_hold");
  const both = await open(made("two_laws"));
  const names = await both.evaluate(() => charts.find((one) => one.title === "Traction over slip").series.map((one) => one.name));
  assert.deepEqual(names.map((name) => name.split(":")[0]), ["hold_slide_hold", "pressure_steps"]);
  assert.ok(await both.getByText("Traction over pressure").count());
  await close(both, "two_laws");
  const mixed = await open(made("run_and_law"));
  assert.ok(await mixed.locator("#law").isVisible() && await mixed.locator("#histories").isVisible());
  await close(mixed);
});

test("two runs are overlaid, and told apart", async () => {
  const page = await open(made("two"));
  assert.equal(await page.locator(".badge").count(), 2);
  // By colour and dashes, as the legend shows them, and by what their cases differ in.
  const chart = page.locator("figure.chart").filter({ hasText: "Normal force in bar" });
  const rows = await chart.locator(".u-legend .u-series").evaluateAll((rows) => rows.slice(1).map((row) => {
    const line = row.querySelector(".sample line");
    return [row.querySelector(".u-label").innerText, line.getAttribute("stroke"), line.getAttribute("stroke-dasharray")];
  }));
  const series = await page.evaluate(() => charts.find((one) => one.title.startsWith("Normal force in bar")).series.map((one) => [one.colour, one.dash.join(" ")]));
  assert.deepEqual(rows.map(([, ...look]) => look), series);
  assert.ok(rows[0][1] !== rows[1][1] && rows[0][2] !== rows[1][2], JSON.stringify(rows));
  for (const [k, name, parts] of [[0, "tube: ", ["tube.material.E = 4", "plate.material.E = 4000"]], [1, "tube_soft: ", ["tube.material.E = 3.6", "plate.material.E = 3600"]]]) {
    assert.ok(rows[k][0].startsWith(name) && parts.every((part) => rows[k][0].includes(part)), rows[k][0]);
  }
  const told = await page.locator("table.differences tbody tr").allInnerTexts();
  assert.deepEqual(told.sort(), ["bodies.plate.material.E\t4000\t3600", "bodies.tube.material.E\t4\t3.6"]);
  await page.locator("#bodies select").first().selectOption("1");
  await page.waitForFunction(() => bodiesView.run.name === "tube_soft" && bodiesView.frame != null);
  await close(page, "two");
});

const faults = {
  missing_frame: /solid\/00007\.vtu is missing/,
  not_a_number: /1 values? of \S+ are not numbers/,
  one_row: null,
  killed: /newton\.csv: line \d+/,
  no_frames: null,
};
for (const [name, told] of Object.entries(faults)) {
  test(`fault ${name} is told and breaks nothing`, async () => {
    const page = await open(made(name));
    if (told) assert.match(await page.locator("#faults").textContent(), told);
    assert.ok(await page.locator("#histories figure.chart").count() > 3);
    await page.evaluate(() => charts.forEach((chart) => chart.draw()));
    if (name === "missing_frame") {
      const written = readFileSync(join(PAGES, "tube", "solid.pvd"), "utf8").match(/<DataSet/g).length;
      assert.equal(await page.evaluate(() => bodiesView.solid.frames.length), written - 1);
    }
    if (name === "killed") assert.match(await text(page, ".badge"), /ended without a status/);
    if (name === "no_frames") assert.equal(await page.locator("#bodies").isVisible(), false);
    await close(page, name);
  });
}

test("it fits a width of 400 pixels, light and dark, and on paper", async () => {
  for (const colorScheme of ["light", "dark"]) {
    const page = await open(of("block_on_ground"), { viewport: { width: 400, height: 800 }, colorScheme });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 400);
    const [r] = (await page.evaluate(() => getComputedStyle(document.body).backgroundColor)).match(/\d+/g);
    assert.equal(+r < 128, colorScheme === "dark");
    if (colorScheme === "light") assert.ok((await page.pdf({ format: "A4" })).length > 20000);
    await close(page, `narrow_${colorScheme}`);
  }
});

test("without WebGL it draws all the same", async () => {
  const other = await chromium.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu", "--disable-webgl", "--disable-webgl2", "--disable-3d-apis"] });
  const page = await other.newPage();
  await page.goto(`file://${of("tube")}`);
  await page.waitForSelector("html[data-ready]", { state: "attached" });
  assert.equal(await page.evaluate(() => bodiesView.scene.constructor.name), "PlainScene");
  const colours = await page.evaluate(() => {
    const { canvas } = bodiesView;
    return new Set(new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
  });
  assert.ok(colours > 20, `${colours} colours`);
  await other.close();
});

/** From the slider to the picture, frame after frame; what it takes is told, on two quiet cores it should be 50 and 150 ms. */
for (const name of ["elements_20000", "elements_100000"]) {
  test(`${name} is drawn at every place of the slider`, async () => {
    const page = await open(made(name), { viewport: { width: 940, height: 900 } });
    await page.waitForFunction(() => bodiesView.solid.frames.every((frame) => peek(frame.displacement)));
    const times = await page.evaluate(async () => {
      const taken = [];
      for (let k = 0; k < 24; k++) {
        await new Promise(requestAnimationFrame);
        const begun = performance.now();
        bodiesView.slider.value = k % 8;
        bodiesView.slider.dispatchEvent(new Event("input"));
        while (bodiesView.frame !== k % 8) await new Promise((done) => setTimeout(done));
        bodiesView.scene.finish();
        taken.push(performance.now() - begun);
      }
      return taken.slice(4).sort((a, b) => a - b);
    });
    const [load] = readFileSync("/proc/loadavg", "utf8").split(" ");
    console.log(`${name}: ${times[10].toFixed(0)} ms (least ${times[0].toFixed(0)}, most ${times[19].toFixed(0)}), load ${load}`);
    assert.equal(times.length, 20);
    await close(page, name);
  });
}

test("a page of a run is written again, in 2 s on two quiet cores", () => {
  const written = statSync(join(PAGES, "block_on_ground", "report.html")).mtimeMs;
  const begun = performance.now();
  execFileSync(PROGRAM, ["report", join(PAGES, "block_on_ground")]);
  const seconds = (performance.now() - begun) / 1000;
  const [load] = readFileSync("/proc/loadavg", "utf8").split(" ");
  console.log(`block_on_ground: ${seconds.toFixed(2)} s, load ${load}`);
  assert.ok(statSync(join(PAGES, "block_on_ground", "report.html")).mtimeMs > written);
});
