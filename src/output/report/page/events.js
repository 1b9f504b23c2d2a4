"use strict";
// Events as a table that jumps there: from events.csv, or else put together from the passages of fronts, or from slip rates.

/** Where no slip rate is given that makes an event: this share of the highest. */
const FAST = 0.01;

/** Mean slip of an event worth showing, over the largest slip of a point. */
const LITTLE = 1e-3;

/** Part of the run that an event must fall short of. */
const SHORT = 0.2;

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

/** Rows of a table of events without those that set out again, before as long a time has passed as it lasted, from where an event
 * had just ruptured: their nucleation is one. */
function nucleations(events) {
  const [contact, onset, duration, place, length] = ["contact", "onset", "duration", "position", "length"].map((name) => events.get(name));
  const all = Array.from({ length: events.rows }, (_, row) => row);
  if (!contact || !onset || !duration || !place) return all;
  const last = new Map();
  return all.filter((row) => {
    const before = last.get(contact[row]);
    const again = before && onset[row] - before.until < Math.max(before.lasted, duration[row]) && Math.abs(place[row] - before.place) <= before.reach;
    const until = onset[row] + duration[row];
    const first = again ? before.first : onset[row];
    const reach = Math.max(length?.[row] ?? 0, again ? before.reach : 0);
    last.set(contact[row], { first, until, lasted: until - first, place: again ? before.place : place[row], reach });
    return !again;
  });
}

/** Events of an interface by its slip rates: rows in which some point is fast. What slips again before it has rested as long as it
 * slipped is one event. */
async function eventsByRates(run, map) {
  const [rates, slips] = ["slip_rate", "slip"].map((name) => map.quantities.find((one) => one.name === name));
  if (!rates || !slips) return [];
  const [times, places, rate, slip] = await Promise.all([unpack(map.times, "f64"), unpack(map.positions, "f64"), unpack(rates.chunk), unpack(slips.chunk)]);
  const points = [...places.keys()];
  const rows = (of, first, last = first) => of.subarray(first * points.length, (last + 1) * points.length);
  const largest = (of) => Math.max(...bounds(of).map(Math.abs));
  const mean = (row) => (row < 0 ? 0 : rows(slip, row).reduce((sum, value) => sum + value, 0) / points.length);
  const start = (row) => (row > 0 ? times[row - 1] : Math.max(0, 2 * times[0] - (times[1] ?? times[0])));
  const lasts = ({ first, last }) => times[last] - start(first);
  const fast = run.summary.front_slip_rate ?? FAST * largest(rate);
  const isFast = (row, k) => Math.abs(rate[row * points.length + k]) > fast;
  const found = [];
  times.forEach((_, row) => {
    if (!points.some((k) => isFast(row, k))) return;
    const before = found[found.length - 1];
    if (before && (before.last === row - 1 || start(row) - times[before.last] < lasts(before))) before.last = row;
    else found.push({ first: row, last: row });
  });
  const enough = LITTLE * largest(slip);
  const short = SHORT * lasts({ first: 0, last: times.length - 1 });
  return found.map(({ first, last }) => {
    const among = Array.from({ length: last - first + 1 }, (_, i) => first + i);
    return {
      contact: map.contact, onset: start(first), duration: lasts({ first, last }), place: places[points.find((k) => isFast(first, k))],
      share: points.filter((k) => among.some((row) => isFast(row, k))).length / points.length,
      slip: Math.abs(mean(last) - mean(first - 1)), peak: largest(rows(rate, first, last)),
    };
  }).filter(({ slip, duration }) => slip > enough && duration < short);
}

async function showEvents() {
  const section = document.getElementById("events");
  for (const run of DATA.runs) {
    const name = several ? `${run.name}: ` : "";
    const events = await table(run.events);
    const fronts = await table(run.fronts);
    if (events && events.rows) {
      const columns = events.names.map((key) => (key === "onset"
        ? [key, (row) => events.get(key)[row] / clock.size, withUnit(spoken(key), clock.unit)]
        : [key, (row) => events.get(key)[row], withUnit(spoken(key), fieldUnit(key))]));
      const time = ["onset", "time", "start"].find((key) => events.get(key));
      const rows = Array.from({ length: events.rows }, (_, row) => row);
      const count = nucleations(events).length;
      const again = count < events.rows ? `, ${events.rows} with those that set out again from where one had just been` : "";
      section.append(el("h3", {}, `${name}${count} event${count > 1 ? "s" : ""}${again}`), tableOf(columns, rows, (row) => time && jump(run, events.get(time)[row],
        events.get("duration")?.[row], events.get("contact")?.[row])));
    } else if (fronts && fronts.rows) {
      const found = eventsOf(fronts);
      const [time, length] = [clock.unit, unitOf("length")];
      const columns = [
        ["event", (row) => row.event, "event"], ["contact", (row) => row.contact, "contact"],
        ["onset", (row) => row.onset / clock.size, withUnit("onset", time)], ["place", (row) => row.place, withUnit("place", length)],
        ["duration", (row) => row.duration, withUnit("duration", unitOf("time"))], ["length", (row) => row.length, withUnit("length", length)],
        ["speed", (row) => row.speed, withUnit("front speed (median)", unitOf("velocity"))],
        ["rayleigh", (row) => row.rayleigh, "speed/c_R"], ["shear", (row) => row.shear, "speed/c_s"],
        ["energy", (row) => row.energy, withUnit("energy released", unitOf("energy"))],
      ];
      section.append(el("h3", {}, `${name}${found.length} event${found.length > 1 ? "s" : ""}, from ${fronts.rows} passages of fronts`),
        tableOf(columns, found, (row) => jump(run, row.onset, row.duration, row.contact)));
    } else {
      const found = (await Promise.all(run.interfaces.map((map) => eventsByRates(run, map)))).flat();
      if (!found.length) continue;
      const [length, velocity] = ["length", "velocity"].map(unitOf);
      const columns = [
        ["contact", (row) => row.contact, "contact"], ["onset", (row) => row.onset / clock.size, withUnit("onset", clock.unit)],
        ["duration", (row) => row.duration, withUnit("duration", unitOf("time"))], ["place", (row) => row.place, withUnit("place", length)],
        ["share", (row) => row.share, "fraction of the points"], ["slip", (row) => row.slip, withUnit("mean slip", length)],
        ["peak", (row) => row.peak, withUnit("peak slip rate", velocity)],
      ];
      section.append(el("h3", {}, `${name}${found.length} event${found.length > 1 ? "s" : ""}, by the slip rates of the interface`),
        tableOf(columns, found, (row) => jump(run, row.onset, row.duration, row.contact)));
    }
    section.hidden = false;
  }
}

/** Go to an event: the time everywhere, the interface close up. */
function jump(run, onset, duration, contact) {
  if (interfaceView) interfaceView.goTo(run, contact, onset, duration);
  now.set(onset, "events");
}
