//! The space–time map of a slip rate, with the wave speeds of the body as slopes.

use std::collections::BTreeMap;

use super::axis::{Axis, Range};
use super::colours::{DECADES, colour, level};
use super::interface::Interface;
use super::source::{Source, Units};
use super::svg::{Anchor, Drawing, Label, Stroke};

/// Cells along each axis at most; each shows the highest slip rate within it.
const CELLS: [usize; 2] = [240, 200];

/// Size of the map of the whole run, and where the first map stands [px].
const SIZE: [f64; 2] = [720.0, 480.0];
const CORNER: [f64; 2] = [76.0, 60.0];

/// Distances of ticks aimed at, along x and y [px].
const BETWEEN_TICKS: [f64; 2] = [75.0, 42.0];

const THIN: Stroke = Stroke { colour: "#222", width: 1.0, dashes: "" };

/// Events that are shown by themselves, at most: those of the most slip.
const EVENTS: usize = 6;

/// Size of the map of one event [px].
const SMALL: [f64; 2] = [330.0, 250.0];

/// What is shown before an event and after its front has arrived everywhere, as shares of the time between.
const BEFORE: f64 = 0.1;
const AFTER: f64 = 0.6;

/// Part of the run that an event must fall short of to be shown by itself.
const SHORT: f64 = 0.2;

/// Height below which the slopes of the wave speeds cannot be told apart [px].
const FLAT: f64 = 12.0;

/// The slip rate of a contact of a folder.
pub struct Map<'a> {
    /// what happened
    pub interface: &'a Interface,
    /// the contact
    pub name: &'a str,
    /// the folder
    pub source: &'a Source,
}

/// A part of the run, and the box into which it is drawn.
struct Window {
    corner: [f64; 2],
    size: [f64; 2],
    place: Range,
    time: Range,
    /// Start and end [T]
    times: [f64; 2],
    /// Time that is called 0 [T]
    zero: f64,
}

impl Window {
    fn at(&self, s: f64, t: f64) -> [f64; 2] {
        let [x, y] = self.corner;
        [x + self.size[0] * self.place.share(s), y + self.size[1] * (1.0 - self.time.share(t - self.zero))]
    }
}

impl Map<'_> {
    /// The figure of the whole run.
    pub fn whole(&self) -> String {
        let mut drawing = Drawing::default();
        self.head(&mut drawing, &format!("Slip rate of {}", self.name));
        let times = &self.interface.times;
        let window = self.window(CORNER, SIZE, [self.interface.start(0), times[times.len() - 1]], 0.0);
        self.draw(&mut drawing, &window, "time");
        self.key(&mut drawing, [CORNER[0] + SIZE[0] + 24.0, CORNER[1] + 0.5 * SIZE[1]]);
        drawing.finish([CORNER[0] + SIZE[0] + 130.0, CORNER[1] + SIZE[1] + 60.0])
    }

    /// The figure of the largest events, each in a time of its own; none if the whole run shows them as well.
    pub fn events(&self) -> Option<String> {
        let interface = self.interface;
        let fast = interface.fast(self.source.about.front_slip_rate);
        let mut events = interface.largest_events(fast, EVENTS);
        let whole = interface.length(&(0..interface.times.len()));
        events.retain(|event| interface.length(&event.rows) < SHORT * whole);
        if events.is_empty() {
            return None;
        }
        let mut drawing = Drawing::default();
        self.head(&mut drawing, &format!("Slip rate of {} in its {} largest events", self.name, events.len()));
        let between = [SMALL[0] + 90.0, SMALL[1] + 90.0];
        for (k, event) in events.iter().enumerate() {
            let corner = [CORNER[0] + (k % 2) as f64 * between[0], CORNER[1] + 25.0 + (k / 2) as f64 * between[1]];
            let start = interface.start(event.rows.start);
            let running = interface.times[interface.row_reaching(event, 1.0, fast)] - start;
            let times = [start - BEFORE * running, start + (1.0 + AFTER) * running];
            let window = self.window(corner, SMALL, times, start);
            let units = self.units();
            let with = |what: String, unit: &str| format!("{what} {unit}").trim_end().to_owned();
            let when = with(format!("t = {start:.6}"), &units.get("time"));
            let slip = with(format!("mean slip {}", number(event.slip)), &units.get("length"));
            bold(&mut drawing, [corner[0], corner[1] - 9.0], &format!("{}: {when}, {slip}", k + 1));
            self.draw(&mut drawing, &window, "time since");
        }
        let right = CORNER[0] + SMALL[0] + between[0];
        self.key(&mut drawing, [right + 24.0, CORNER[1] + 60.0]);
        let rows = events.len().div_ceil(2) as f64;
        Some(drawing.finish([right + 130.0, CORNER[1] + 25.0 + rows * between[1]]))
    }

    fn units(&self) -> Units {
        Units::of(std::slice::from_ref(self.source))
    }

    fn head(&self, drawing: &mut Drawing, title: &str) {
        let label = Label { text: title, size: 15.0, anchor: Anchor::Start, bold: true, upright: false };
        drawing.text([CORNER[0], 24.0], label);
        let subtitle = if self.source.about.title.is_empty() { &self.source.name } else { &self.source.about.title };
        text(drawing, [CORNER[0], 44.0], subtitle, 11.5, Anchor::Start);
    }

    fn axes(&self, time: &str) -> [Axis; 2] {
        let units = self.units();
        [Axis::new("position along the slave", units.get("length")), Axis::new(time, units.get("time"))]
    }

    fn window(&self, corner: [f64; 2], size: [f64; 2], times: [f64; 2], zero: f64) -> Window {
        let [place, time] = self.axes("");
        let place = Range::of(&place, self.interface.positions.iter().copied(), 0.0);
        let time = Range::of(&time, times.iter().map(|t| t - zero), 0.0);
        Window { corner, size, place, time, times, zero }
    }

    /// The map, its axes and the slopes of the wave speeds.
    fn draw(&self, drawing: &mut Drawing, window: &Window, time: &str) {
        self.cells(drawing, window);
        let Window { corner: [x, y], size: [width, height], .. } = *window;
        drawing.frame([x, y], [width, height], THIN);
        let [along, time] = self.axes(time);
        let (ticks, name) = window.place.ticks(&along, width / BETWEEN_TICKS[0]);
        for tick in ticks {
            let at = x + width * tick.share;
            drawing.line([at, y + height], [at, y + height + 4.0], THIN);
            text(drawing, [at, y + height + 17.0], &tick.label, 11.5, Anchor::Middle);
        }
        text(drawing, [x + 0.5 * width, y + height + 34.0], &name, 11.5, Anchor::Middle);
        let (ticks, name) = window.time.ticks(&time, height / BETWEEN_TICKS[1]);
        for tick in ticks {
            let at = y + height * (1.0 - tick.share);
            drawing.line([x - 4.0, at], [x, at], THIN);
            text(drawing, [x - 7.0, at + 4.0], &tick.label, 11.5, Anchor::End);
        }
        let label = Label { text: &name, size: 11.5, anchor: Anchor::Middle, bold: false, upright: true };
        drawing.text([x - 52.0, y + 0.5 * height], label);
        self.slopes(drawing, window);
    }

    /// Filled cells, each with the highest slip rate within it, neighbours of one colour in a row as one.
    fn cells(&self, drawing: &mut Drawing, window: &Window) {
        let interface = self.interface;
        let [x0, y0] = window.corner;
        let size = window.size;
        let count = [0, 1].map(|i| CELLS[i].min(size[i] as usize / 3));
        let columns = count[0].min(interface.positions.len());
        let mut rates = vec![0.0f64; columns * count[1]];
        let column = |s: f64| ((window.place.share(s) * columns as f64) as usize).min(columns - 1);
        let (own, nearest) = interface.columns(column, columns);
        for row in 0..interface.times.len() {
            let (from, to) = (interface.start(row), interface.times[row]);
            if to <= window.times[0] || from >= window.times[1] {
                continue;
            }
            // A mean over an interval holds in all of it, but an interval that ends on the edge of a cell is not in the
            // next one.
            let [first, last] = [from, to].map(|t| window.time.share(t - window.zero) * count[1] as f64);
            let bins = (first + EDGE) as usize..=((last - EDGE) as usize).min(count[1] - 1);
            for (column, rate) in own.iter().zip(interface.rates(row)) {
                for cell in bins.clone().map(|row| row * columns + column) {
                    rates[cell] = rates[cell].max(*rate);
                }
            }
        }
        let highest = interface.highest_rate();
        let cell = [size[0] / columns as f64, size[1] / count[1] as f64];
        let mut filled: BTreeMap<String, Vec<[[f64; 2]; 2]>> = BTreeMap::new();
        for (row, rates) in rates.chunks(columns).enumerate() {
            let colours: Vec<String> = nearest.iter().map(|&column| colour(level(rates[column], highest))).collect();
            let bottom = y0 + size[1] - row as f64 * cell[1];
            let mut first = 0;
            for run in colours.chunk_by(|a, b| a == b) {
                let [left, right] = [first, first + run.len()].map(|column| x0 + column as f64 * cell[0]);
                filled.entry(run[0].clone()).or_default().push([[left, bottom - cell[1]], [right, bottom]]);
                first += run.len();
            }
        }
        filled.retain(|colour, _| colour != "#ffffff");
        filled.iter().for_each(|(colour, rectangles)| drawing.fill_all(rectangles, colour));
    }

    /// What the colours mean, below and to the right of a place.
    fn key(&self, drawing: &mut Drawing, [x, y]: [f64; 2]) {
        const STEPS: u32 = 40;
        const HEIGHT: f64 = 240.0;
        let step = HEIGHT / f64::from(STEPS);
        for k in 0..STEPS {
            let level = (f64::from(k) + 0.5) / f64::from(STEPS);
            drawing.fill([x, y + HEIGHT - f64::from(k + 1) * step], [14.0, step + 0.5], &colour(level));
        }
        drawing.frame([x, y], [14.0, HEIGHT], THIN);
        let units = self.units();
        text(drawing, [x, y - 24.0], "slip rate", 11.5, Anchor::Start);
        let rate = units.derived("velocity", ["length", "time"], "/_");
        if !rate.is_empty() {
            text(drawing, [x, y - 9.0], &format!("[{rate}]"), 11.5, Anchor::Start);
        }
        let highest = self.interface.highest_rate();
        for k in 0..=4 {
            let share = f64::from(k) / 4.0;
            let at = [x + 20.0, y + HEIGHT * (1.0 - share) + 4.0];
            text(drawing, at, &number(highest * 10f64.powf(DECADES * (share - 1.0))), 11.5, Anchor::Start);
        }
    }

    /// The wave speeds as slopes, in the lower corner that slip leaves emptier; none if time runs too slowly for them.
    fn slopes(&self, drawing: &mut Drawing, window: &Window) {
        let speeds = self.source.about.wave_speeds;
        let speeds = [("c_R", speeds[0], ""), ("c_s", speeds[1], "6 3"), ("c_p", speeds[2], "2 3")];
        let slowest =
            speeds.iter().map(|(_, speed, _)| *speed).filter(|speed| *speed > 0.0).fold(f64::INFINITY, f64::min);
        let (low, high) = bounds(&self.interface.positions);
        let [start, end] = window.times;
        let time = (0.35 * (end - start)).min(0.25 * (high - low) / slowest);
        if time <= FLAT / window.size[1] * (end - start) {
            return;
        }
        // The lines rise to the side on which less slips.
        let right = !self.slips_on_the_right(window);
        let (side, toward) = if right { (high, 1.0) } else { (low, -1.0) };
        let [along, outside] = if right { [Anchor::End, Anchor::Start] } else { [Anchor::Start, Anchor::End] };
        let origin = [side - toward * 0.33 * (high - low), start + 0.04 * (end - start)];
        for (name, speed, dashes) in speeds.into_iter().filter(|(_, speed, _)| *speed > 0.0 && speed.is_finite()) {
            let time = time.min(0.25 * (high - low) / speed);
            let [x, y] = window.at(origin[0] + toward * speed * time, origin[1] + time);
            drawing.line(window.at(origin[0], origin[1]), [x, y], Stroke { colour: "#0060a0", width: 1.6, dashes });
            // c_R and c_s end close to each other.
            let (at, anchor) =
                if name == "c_R" { ([x, y - 5.0], along) } else { ([x + 4.0 * toward, y + 4.0], outside) };
            text(drawing, at, name, 11.5, anchor);
        }
    }

    /// Whether the first half of a window sees more slip right of the middle than left of it.
    fn slips_on_the_right(&self, window: &Window) -> bool {
        let interface = self.interface;
        let middle = 0.5 * (window.times[0] + window.times[1]);
        let rows = (0..interface.times.len())
            .filter(|&row| interface.times[row] > window.times[0] && interface.times[row] < middle);
        let mut halves = [0.0; 2];
        for row in rows {
            let dt = interface.times[row] - interface.start(row);
            for (s, rate) in interface.positions.iter().zip(interface.rates(row)) {
                halves[usize::from(window.place.share(*s) > 0.5)] += rate * dt;
            }
        }
        halves[1] > halves[0]
    }
}

/// Share of a cell by which an interval must reach into it.
const EDGE: f64 = 1e-6;

fn bounds(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (low, high)
}

fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e6).contains(&size) => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}

fn text(drawing: &mut Drawing, at: [f64; 2], text: &str, size: f64, anchor: Anchor) {
    drawing.text(at, Label { text, size, anchor, bold: false, upright: false });
}

fn bold(drawing: &mut Drawing, at: [f64; 2], text: &str) {
    drawing.text(at, Label { text, size: 11.5, anchor: Anchor::Start, bold: true, upright: false });
}
