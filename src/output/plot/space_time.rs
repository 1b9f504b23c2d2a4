//! The space–time map of a slip rate, with the wave speeds of the body as slopes.

use std::path::Path;

use super::read::Columns;
use super::svg::{Anchor, Drawing, Label, Stroke};
use super::{PlotError, Source, Units};

/// Cells along each axis at most; each shows the highest slip rate within it.
const CELLS: [usize; 2] = [240, 200];

/// Size of the map, and where it stands [px].
const SIZE: [f64; 2] = [720.0, 480.0];
const CORNER: [f64; 2] = [80.0, 60.0];
const WHOLE: [f64; 2] = [930.0, 610.0];

/// Slip rates are told apart over so many powers of ten below the highest.
const DECADES: f64 = 4.0;

/// Colours from the lowest to the highest, printed in grey they rise in darkness.
const COLOURS: [[f64; 3]; 5] =
    [[255.0, 255.0, 255.0], [253.0, 212.0, 120.0], [240.0, 110.0, 60.0], [170.0, 20.0, 90.0], [40.0, 0.0, 70.0]];

const THIN: Stroke = Stroke { colour: "#222", width: 1.0, dashes: "" };

/// The map of one contact of a folder, if it has a `slip_map.csv`.
pub struct Map {
    times: Vec<f64>,
    positions: Vec<f64>,
    rates: Vec<f64>,
}

impl Map {
    /// The maps of a folder, one a contact by its number.
    pub fn read(folder: &Path) -> Result<Vec<(usize, Self)>, PlotError> {
        let path = folder.join("slip_map.csv");
        if !path.is_file() {
            return Ok(Vec::new());
        }
        let columns = Columns::read(&path, |name| ["time", "number", "position", "slip_rate"].contains(&name))?;
        let get = |name: &str| columns.get(name);
        let (times, numbers, positions, rates) = (get("time")?, get("number")?, get("position")?, get("slip_rate")?);
        let last = numbers.iter().fold(0.0, |most: f64, number| most.max(*number)) as usize;
        let of = |number: usize| {
            let rows: Vec<usize> = (0..numbers.len()).filter(|&row| numbers[row] as usize == number).collect();
            let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect();
            (number, Self { times: pick(times), positions: pick(positions), rates: pick(rates) })
        };
        Ok((0..=last).map(of).filter(|(_, map)| !map.times.is_empty()).collect())
    }

    /// The figure.
    pub fn svg(&self, title: &str, source: &Source) -> String {
        let units = Units::of(std::slice::from_ref(source));
        let mut drawing = Drawing::default();
        let [x0, y0] = CORNER;
        let [width, height] = SIZE;
        let (left, right) = bounds(&self.positions);
        let (start, end) = bounds(&self.times);
        let place = |s: f64, t: f64| [x0 + width * share(s, left, right), y0 + height * (1.0 - share(t, start, end))];
        let highest = self.rates.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()));
        let level = |rate: f64| match rate.abs() / highest {
            of if of > 0.0 => (1.0 + of.log10() / DECADES).clamp(0.0, 1.0),
            _ => 0.0,
        };
        self.cells(&mut drawing, |rate| colour(level(rate)), place);
        drawing.frame(CORNER, SIZE, THIN);
        text(&mut drawing, [x0, 24.0], title, 15.0, Anchor::Start);
        let subtitle = if source.about.title.is_empty() { &source.name } else { &source.about.title };
        text(&mut drawing, [x0, 44.0], subtitle, 11.0, Anchor::Start);
        for s in ticks(left, right) {
            text(&mut drawing, [place(s, start)[0], y0 + height + 16.0], &number(s), 11.0, Anchor::Middle);
        }
        for t in ticks(start, end) {
            text(&mut drawing, [x0 - 6.0, place(left, t)[1] + 4.0], &number(t), 11.0, Anchor::End);
        }
        let with = |what: &str, unit: String| if unit.is_empty() { what.into() } else { format!("{what} [{unit}]") };
        let along = with("position along the slave", units.get("length"));
        text(&mut drawing, [x0 + 0.5 * width, y0 + height + 36.0], &along, 12.0, Anchor::Middle);
        let time = with("time", units.get("time"));
        let label = Label { text: &time, size: 12.0, anchor: Anchor::Middle, bold: false, upright: true };
        drawing.text([22.0, y0 + 0.5 * height], label);
        self.key(&mut drawing, highest);
        self.slopes(&mut drawing, source, place, (left, right), (start, end));
        drawing.finish(WHOLE)
    }

    /// Filled cells, neighbours of one colour in a row as one.
    fn cells(&self, drawing: &mut Drawing, colour: impl Fn(f64) -> String, place: impl Fn(f64, f64) -> [f64; 2]) {
        let (left, right) = bounds(&self.positions);
        let (start, end) = bounds(&self.times);
        let [mut places, mut times] = [self.positions.clone(), self.times.clone()];
        for values in [&mut places, &mut times] {
            values.sort_by(f64::total_cmp);
            values.dedup();
        }
        let [columns, rows] = [CELLS[0].min(places.len()), CELLS[1].min(times.len())];
        let mut rates = vec![0.0f64; columns * rows];
        let bin = |part: f64, count: usize| ((part * count as f64) as usize).min(count - 1);
        for ((s, t), rate) in self.positions.iter().zip(&self.times).zip(&self.rates) {
            let cell = bin(share(*t, start, end), rows) * columns + bin(share(*s, left, right), columns);
            rates[cell] = rates[cell].max(rate.abs());
        }
        let (ds, dt) = ((right - left) / columns as f64, (end - start) / rows as f64);
        for (row, rates) in rates.chunks(columns).enumerate() {
            let colours: Vec<String> = rates.iter().map(|rate| colour(*rate)).collect();
            let mut first = 0;
            for run in colours.chunk_by(|a, b| a == b) {
                let [x, y] = place(left + first as f64 * ds, start + (row + 1) as f64 * dt);
                first += run.len();
                let [x1, y1] = place(left + first as f64 * ds, start + row as f64 * dt);
                if run[0] != "#ffffff" {
                    drawing.fill([x, y], [x1 - x, y1 - y], &run[0]);
                }
            }
        }
    }

    /// What the colours mean.
    fn key(&self, drawing: &mut Drawing, highest: f64) {
        let [x, y] = [CORNER[0] + SIZE[0] + 24.0, CORNER[1] + 0.5 * SIZE[1]];
        let steps = 40;
        let step = 0.5 * SIZE[1] / f64::from(steps);
        for k in 0..steps {
            let level = (f64::from(k) + 0.5) / f64::from(steps);
            let at = [x, y + 0.5 * SIZE[1] - f64::from(k + 1) * step];
            drawing.fill(at, [14.0, step + 0.5], &colour(level));
        }
        drawing.frame([x, y], [14.0, 0.5 * SIZE[1]], THIN);
        text(drawing, [x, y - 10.0], "slip rate", 11.0, Anchor::Start);
        for k in 0..=4 {
            let value = highest * 10f64.powf(DECADES * (f64::from(k) / 4.0 - 1.0));
            let at = [x + 20.0, y + 0.5 * SIZE[1] * (1.0 - f64::from(k) / 4.0) + 4.0];
            text(drawing, at, &number(value), 10.0, Anchor::Start);
        }
    }

    /// The wave speeds as slopes in the upper right, each from one point.
    fn slopes(
        &self,
        drawing: &mut Drawing,
        source: &Source,
        place: impl Fn(f64, f64) -> [f64; 2],
        (left, right): (f64, f64),
        (start, end): (f64, f64),
    ) {
        let origin = [left + 0.04 * (right - left), start + 0.04 * (end - start)];
        let speeds = source.about.wave_speeds;
        for (name, speed, dashes) in [("c_R", speeds[0], ""), ("c_s", speeds[1], "6 3"), ("c_p", speeds[2], "2 3")] {
            if !(speed > 0.0 && speed.is_finite()) {
                continue;
            }
            let time = (0.3 * (end - start)).min(0.3 * (right - left) / speed);
            let to = place(origin[0] + speed * time, origin[1] + time);
            drawing.line(place(origin[0], origin[1]), to, Stroke { colour: "#0060a0", width: 1.6, dashes });
            let (shift, anchor) = if name == "c_R" { (-3.0, Anchor::End) } else { (4.0, Anchor::Start) };
            text(drawing, [to[0] + shift, to[1] + 4.0], name, 11.0, anchor);
        }
    }
}

fn bounds(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (low, high)
}

/// Round numbers within a range.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let raw = (high - low) / 6.0;
    if !(raw > 0.0 && raw.is_finite()) {
        return vec![low];
    }
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0].map(|part| part * power).into_iter().find(|step| *step >= raw).unwrap_or(10.0 * power);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

fn share(value: f64, low: f64, high: f64) -> f64 {
    if high > low { (value - low) / (high - low) } else { 0.5 }
}

fn colour(level: f64) -> String {
    let at = level * (COLOURS.len() - 1) as f64;
    let k = (at as usize).min(COLOURS.len() - 2);
    let mixed = [0, 1, 2].map(|i| COLOURS[k][i] + (at - k as f64) * (COLOURS[k + 1][i] - COLOURS[k][i]));
    // Few different colours, so that neighbours often share one.
    let [r, g, b] = mixed.map(|value| (8.0 * (value / 8.0).round()).min(255.0) as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e6).contains(&size) => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}

fn text(drawing: &mut Drawing, at: [f64; 2], text: &str, size: f64, anchor: Anchor) {
    drawing.text(at, Label { text, size, anchor, bold: false, upright: false });
}
