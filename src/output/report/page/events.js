"use strict";
// Events as a table that jumps there: from events.csv, or else put together from the passages of fronts.

/** A table that can be sorted; columns are [key, value of a row, heading]. A click on a row goes there. */
function tableOf(columns, rows, go) {
  const most = 300;
  const body = el("tbody");
  const foot = el("div", { class: "probe" });
  let all = rows;
  const fill = (count) => {
    body.replaceChildren(...all.slice(0, count).map((row) => {
      const cells = columns.map(([, value]) => {
        const found = value(row);
        return el("td", { class: isWords(found) ? (found.length > 30 ? "words long" : "words") : null }, typeof found === "number" ? told(found, 6) : found ?? "");
      });
      const jump = () => {
        body.querySelectorAll(".chosen").forEach((other) => other.classList.remove("chosen"));
        line.classList.add("chosen");
        go(row);
      };
      const line = el("tr", { tabindex: 0, onclick: jump, onkeydown: (event) => event.key === "Enter" && jump() }, cells);
      return line;
    }));
    foot.replaceChildren(...(all.length > count
      ? [`${count} of ${all.length} rows. `, button("Show all", "Show all rows", () => fill(all.length))] : []));
  };
  let [by, down] = [null, false];
  const head = columns.map(([key, value, heading]) => el("th", { scope: "col", class: rows.length && isWords(value(rows[0])) ? "words" : null }, button(heading, `Sort by ${heading}`, () => {
    down = by === key ? !down : false;
    by = key;
    const order = (a, b) => (typeof a === "string" ? a.localeCompare(b) : (a ?? -Infinity) - (b ?? -Infinity));
    all = [...rows].sort((a, b) => (down ? -1 : 1) * order(value(a), value(b)));
    fill(Math.max(most, body.children.length));
  })));
  fill(most);
  const saveAll = button("CSV", "Save this table as CSV", () =>
    save("table.csv", csv(columns.map(([, , heading]) => heading), columns.map(([, value]) => all.map(value))), "text/csv"));
  return el("div", {}, el("div", { class: "scroll", tabindex: 0 }, el("table", {}, el("thead", {}, el("tr", {}, head)), body)), foot,
    el("span", { class: "tools" }, saveAll));
}

const isWords = (value) => typeof value === "string" && /[a-z]{3}/i.test(value);

/** Middle value. */
function median(values) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length ? sorted[sorted.length >> 1] : NaN;
}

/** Events of a run from the passages of its fronts. */
function eventsOf(fronts) {
  const [contact, number, arrival, place] = ["contact", "event", "arrival", "position"].map((name) => fronts.get(name));
  if (!contact || !number || !arrival) return [];
  const events = new Map();
  for (let row = 0; row < fronts.rows; row++) {
    const key = `${contact[row]} ${number[row]}`;
    if (!events.has(key)) events.set(key, []);
    events.get(key).push(row);
  }
  const value = (name, row) => (fronts.get(name) ? fronts.get(name)[row] : NaN);
  return [...events.values()].map((rows) => {
    const first = rows.reduce((a, b) => (arrival[b] < arrival[a] ? b : a));
    const last = rows.reduce((a, b) => (arrival[b] > arrival[a] ? b : a));
    const highest = (name) => Math.max(...rows.map((row) => value(name, row)).filter(Number.isFinite), 0);
    return {
      contact: contact[first], event: number[first], onset: arrival[first], place: place ? place[first] : NaN,
      duration: arrival[last] - arrival[first], length: highest("rupture_length"), points: rows.length,
      speed: median(rows.map((row) => value("speed", row))), rayleigh: median(rows.map((row) => value("speed_over_c_R", row))),
      shear: median(rows.map((row) => value("speed_over_c_s", row))), energy: value("energy_released", last),
    };
  }).sort((a, b) => a.onset - b.onset);
}

async function showEvents() {
  const section = document.getElementById("events");
  for (const run of DATA.runs) {
    const name = several ? `${run.name}: ` : "";
    const events = await table(run.events);
    const fronts = await table(run.fronts);
    if (events && events.rows) {
      const columns = events.names.map((key) => [key, (row) => events.get(key)[row], spoken(key)]);
      const time = ["onset", "time", "start"].find((key) => events.get(key));
      const rows = Array.from({ length: events.rows }, (_, row) => row);
      section.append(el("h3", {}, `${name}${events.rows} events`), tableOf(columns, rows, (row) => time && jump(run, events.get(time)[row],
        events.get("duration")?.[row], events.get("contact")?.[row])));
    } else if (fronts && fronts.rows) {
      const found = eventsOf(fronts);
      const [time, length] = [unitOf("time"), unitOf("length")];
      const columns = [
        ["event", (row) => row.event, "event"], ["contact", (row) => row.contact, "contact"],
        ["onset", (row) => row.onset, withUnit("onset", time)], ["place", (row) => row.place, withUnit("place", length)],
        ["duration", (row) => row.duration, withUnit("duration", time)], ["length", (row) => row.length, withUnit("length", length)],
        ["speed", (row) => row.speed, withUnit("front speed (median)", unitOf("velocity"))],
        ["rayleigh", (row) => row.rayleigh, "speed/c_R"], ["shear", (row) => row.shear, "speed/c_s"],
        ["energy", (row) => row.energy, withUnit("energy released", unitOf("energy"))],
      ];
      section.append(el("h3", {}, `${name}${found.length} event${found.length > 1 ? "s" : ""}, from ${fronts.rows} passages of fronts`),
        tableOf(columns, found, (row) => jump(run, row.onset, row.duration, row.contact)));
    } else continue;
    section.hidden = false;
  }
}

/** Go to an event: the time everywhere, the interface close up. */
function jump(run, onset, duration, contact) {
  if (interfaceView) interfaceView.goTo(run, contact, onset, duration);
  now.set(onset, "events");
}
