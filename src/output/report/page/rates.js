"use strict";
// How fast an interface slips, how far it has slipped, and how it sped up before each of its events.

/** Events of which the time before them is drawn: the last ones. */
const BEFORE = 7;

class Rates {
  constructor() {
    const [time, empty] = [timeAxis(), { label: "" }];
    this.largest = new Chart({ title: "Largest slip rate", x: time, y: { label: "slip rate", log: true }, series: [], time: true });
    this.slip = new Chart({ title: "Cumulative slip", x: time, y: empty, series: [], time: true });
    const before = { label: withUnit("time to the event", unitOf("time")), log: true, reverse: true };
    this.before = new Chart({ title: "Before the events", x: before, y: { label: "slip rate", log: true }, series: [] });
    this.charts = [this.largest, this.slip, this.before];
  }

  async show(run, map) {
    const of = (name) => map.quantities.find((one) => one.name === name && one.range[0] !== one.range[1]);
    const [rate, slip] = [of("slip_rate"), of("slip")];
    const [times, places] = await Promise.all([unpack(map.times, "f64"), unpack(map.positions, "f64")]);
    const enough = map.rows > 2;
    this.largest.element.hidden = !rate || !enough;
    this.slip.element.hidden = !slip || !enough;
    this.before.element.hidden = true;
    const velocity = { label: withUnit("largest slip rate", unitOf("velocity")), log: true };
    if (slip && enough) {
      const values = await unpack(slip.chunk);
      const row = (k) => values.subarray(k * places.length, (k + 1) * places.length);
      const series = [["largest", (k) => largestOf(row(k))], ["mean", (k) => meanOf(row(k), places)]].map(([name, y], i) => (
        { name, x: times, y: Float64Array.from(times, (_, k) => y(k)), colour: curveColour(i), dash: dash(i) }));
      this.slip.set(series, `Cumulative slip of ${map.contact}`, { label: withUnit("slip", unitOf("length")) });
    }
    if (!rate || !enough) return;
    const values = await unpack(rate.chunk);
    const fastest = Float64Array.from(times, (_, k) => largestOf(values.subarray(k * places.length, (k + 1) * places.length)));
    this.largest.set([{ name: "largest slip rate", x: times, y: fastest, colour: curveColour(0), plain: true }], `Largest slip rate of ${map.contact}`, velocity);
    const series = beforeEvents(await table(run.events), map.contact, times, fastest);
    this.before.element.hidden = !series.length;
    this.before.set(series, `Largest slip rate of ${map.contact} before its events`, velocity);
  }
}

const largestOf = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);

/** Mean of the size of values along places, by length. */
function meanOf(values, places) {
  let sum = 0;
  for (let k = 1; k < places.length; k++) sum += 0.5 * Math.abs(values[k - 1] + values[k]) * (places[k] - places[k - 1]);
  const length = places[places.length - 1] - places[0];
  return length > 0 ? sum / length : Math.abs(values[0]);
}

/** Slip rates over the time that is left to the next event, one curve an event. */
function beforeEvents(events, contact, times, fastest) {
  if (!events?.get("onset")) return [];
  const rows = nucleations(events).filter((row) => (events.get("contact")?.[row] ?? contact) === contact);
  const [onset, duration] = [events.get("onset"), events.get("duration")];
  const series = rows.map((row, k) => {
    const from = k ? onset[rows[k - 1]] + (duration?.[rows[k - 1]] || 0) : -Infinity;
    const among = [...times.keys()].filter((i) => times[i] > from && times[i] < onset[row]).reverse();
    const name = `to the event at ${timed(onset[row])}`;
    return { name, x: Float64Array.from(among, (i) => onset[row] - times[i]), y: Float64Array.from(among, (i) => fastest[i]), plain: true };
  });
  return series.filter(({ x }) => x.length > 2).slice(-BEFORE).map((one, k) => ({ ...one, colour: curveColour(k), dash: dash(k) }));
}
