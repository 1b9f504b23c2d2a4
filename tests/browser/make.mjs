// Makes the folders of results and the pages that are tested: shortened runs of committed cases, faults put into their files, and
// grids of many elements.
import { execFileSync, spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateSync } from "node:zlib";

const [program, work] = process.argv.slice(2);
const cases = resolve(dirname(fileURLToPath(import.meta.url)), "../../cases");

/** A committed case, changed, run into a folder of its own. */
function run(name, file, change = () => {}) {
  const source = join(cases, file);
  const written = JSON.parse(readFileSync(source, "utf8"));
  if (typeof written.mesh === "string") written.mesh = resolve(dirname(source), written.mesh);
  change(written);
  const path = join(work, `${name}.json`);
  writeFileSync(path, JSON.stringify(written));
  const { status, stderr } = spawnSync(program, ["run", path, "--out", join(work, name), "--quiet"], { encoding: "utf8" });
  console.log(`${name}: exit ${status}${stderr ? `, ${stderr.trim().slice(0, 200)}` : ""}`);
  if (!existsSync(join(work, name, "report.html"))) throw new Error(`${name}: the run left no page`);
}

const page = (name, ...folders) =>
  execFileSync(program, ["report", ...folders.map((folder) => join(work, folder)), "--out", join(work, `${name}.html`)]);

run("block_on_ground", "block_on_ground.json");
const everyRow = (written) => (written.output = { ...written.output, every: 1 });
run("tube", "tube.json", everyRow);
run("tube_soft", "tube.json", (written) => {
  everyRow(written);
  for (const body of Object.values(written.bodies)) if (body.material.E) body.material.E *= 0.9;
});
run("slip_front", "slip_front.json", (written) => {
  const last = written.steps[written.steps.length - 1];
  last.duration = Math.min(last.duration, 0.56);
});
run("spring_mass_3", "paper/spring_mass_3.json", (written) => {
  const last = written.steps[written.steps.length - 1];
  last.duration = 3200;
});
run("stopped", "tube.json", (written) => {
  written.newton = { ...written.newton, max_iterations: 3 };
});
page("two", "tube", "tube_soft");
run("anchored_wall", "anchored_wall.json");
run("fault", "templates/fault.json");

/** A committed test of a law. */
const law = (name) => execFileSync(program, ["law", join(cases, "law", `${name}.json`), "--out", join(work, name)], { stdio: "ignore" });
law("hold_slide_hold");
law("pressure_steps");
page("two_laws", "hold_slide_hold", "pressure_steps");
page("run_and_law", "spring_mass_3", "pressure_steps");

/** A copy of a folder with a fault put into it. */
function fault(name, from, change) {
  const folder = join(work, name);
  cpSync(join(work, from), folder, { recursive: true });
  rmSync(join(folder, "report.html"));
  change(folder);
  page(name, name);
}
const rows = (folder, change) => {
  const file = join(folder, "history.csv");
  writeFileSync(file, change(readFileSync(file, "utf8").trimEnd().split("\n")).join("\n") + "\n");
};
fault("missing_frame", "tube", (folder) => rmSync(join(folder, "solid", "00007.vtu")));
fault("not_a_number", "tube", (folder) => rows(folder, (lines) => {
  const cells = lines[9].split(",");
  cells[11] = "NaN";
  lines[9] = cells.join(",");
  return lines;
}));
fault("one_row", "tube", (folder) => rows(folder, (lines) => lines.slice(0, 2)));
fault("killed", "tube", (folder) => {
  const file = join(folder, "summary.json");
  writeFileSync(file, readFileSync(file, "utf8").replace('"completed"', '"running"'));
  for (const frame of readdirSync(join(folder, "solid")).slice(20)) rmSync(join(folder, "solid", frame));
  writeFileSync(join(folder, "newton.csv"), readFileSync(join(folder, "newton.csv"), "utf8").slice(0, -40) + "\nhalf,a,line\n");
});
fault("no_fronts", "slip_front", (folder) => ["fronts.csv", "events.csv"].forEach((name) => rmSync(join(folder, name))));
fault("no_frames", "tube", (folder) => {
  for (const name of ["solid", "contact", "solid.pvd", "contact.pvd"]) rmSync(join(folder, name), { recursive: true });
});

/** An array of a VTU file as the program writes it: one compressed block in base64, behind a head of its own. */
function array(type, name, components, values) {
  const bytes = Buffer.from(values.buffer);
  const packed = deflateSync(bytes, { level: 1 });
  const head = Buffer.from(BigUint64Array.of(1n, BigInt(bytes.length), 0n, BigInt(packed.length)).buffer);
  return `<DataArray type="${type}" Name="${name}" NumberOfComponents="${components}" format="binary">` +
    `${head.toString("base64")}${packed.toString("base64")}</DataArray>`;
}

/** Frames of so many by so many elements in a wave. */
function grid(name, nx, ny, frames) {
  const folder = join(work, name);
  mkdirSync(join(folder, "solid"), { recursive: true });
  const points = (nx + 1) * (ny + 1);
  const places = Float64Array.from({ length: 3 * points }, (_, k) => [(Math.floor(k / 3) % (nx + 1)) / nx, Math.floor(Math.floor(k / 3) / (nx + 1)) / nx, 0][k % 3]);
  const corners = [];
  for (let j = 0; j < ny; j++) for (let i = 0; i < nx; i++) {
    const k = j * (nx + 1) + i;
    corners.push(k, k + 1, k + nx + 2, k + nx + 1);
  }
  const big = (values) => BigUint64Array.from(values, (value) => BigInt(value));
  const cells = array("UInt64", "connectivity", 1, big(corners)) + array("UInt64", "offsets", 1, big(Array.from({ length: nx * ny }, (_, k) => 4 * (k + 1)))) +
    array("UInt8", "types", 1, new Uint8Array(nx * ny).fill(9));
  const [sets, history] = [[], ["time,dt,step,iterations,kinetic"]];
  for (let f = 0; f < frames; f++) {
    const wave = (k) => Math.sin(12 * places[3 * k] + f) * Math.cos(7 * places[3 * k + 1]);
    const moved = Float64Array.from({ length: 3 * points }, (_, k) => (k % 3 === 1 ? 0.02 * wave(Math.floor(k / 3)) : 0));
    const stress = Float64Array.from({ length: points }, (_, k) => 100 * wave(k) ** 2);
    writeFileSync(join(folder, "solid", `0000${f}.vtu`), `<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<UnstructuredGrid><Piece NumberOfPoints="${points}" NumberOfCells="${nx * ny}"><Points>${array("Float64", "Points", 3, places)}</Points><Cells>${cells}</Cells>
<PointData>${array("Float64", "displacement", 3, moved)}${array("Float64", "von_mises", 1, stress)}</PointData></Piece></UnstructuredGrid></VTKFile>`);
    sets.push(`<DataSet timestep="${f}" part="0" file="solid/0000${f}.vtu"/>`);
    history.push(`${f},1,go,1,${f}`);
  }
  writeFileSync(join(folder, "solid.pvd"), `<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>${sets.join("\n")}</Collection></VTKFile>`);
  writeFileSync(join(folder, "history.csv"), history.join("\n") + "\n");
  writeFileSync(join(folder, "summary.json"), JSON.stringify({ status: "completed", title: `${nx * ny} elements`, version: "0", files: [] }));
  page(name, name);
}
grid("elements_20000", 200, 100, 8);
grid("elements_100000", 400, 250, 8);
