//! Panels of curves, and a figure of panels.

use super::axis::{Axis, Range};
use super::svg::{Anchor, Drawing, Label, Shape, Stroke, text_width};
use super::thin::thin;

/// A figure: panels in rows under a title.
#[derive(Clone, Debug)]
pub struct Figure {
    /// what is shown
    pub title: String,
    /// of what
    pub subtitle: String,
    /// panels side by side, 1 or 2
    pub columns: usize,
    /// the panels, row by row
    pub panels: Vec<Panel>,
}

/// Curves over common axes.
#[derive(Clone, Debug)]
pub struct Panel {
    /// what is shown, above the panel
    pub title: String,
    /// horizontal axis
    pub x: Axis,
    /// vertical axis
    pub y: Axis,
    /// the curves; a legend names them if there are several
    pub curves: Vec<Curve>,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// its name in the legend
    pub name: String,
    /// (x, y); broken where not finite
    pub points: Vec<[f64; 2]>,
    /// how it is drawn
    pub look: Look,
}

/// How a curve is drawn; the number tells it apart from the others of its panel by colour, dashes and marks (left out
/// where it is alone).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// a line with a few marks
    Line(usize),
    /// a mark at every point, joined by a line
    Points(usize),
    /// a thin pale line without marks
    Pale(usize),
    /// a bound, grey
    Bound(usize),
}

const COLOURS: [&str; 7] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9"];
const DASHES: [&str; 4] = ["", "7 3", "2 2", "9 3 2 3"];
const SHAPES: [Shape; 5] = [Shape::Circle, Shape::Square, Shape::Triangle, Shape::Diamond, Shape::Cross];
const BOUNDS: [&str; 2] = ["6 3", "1.5 2.5"];

const TEXT: &str = "#222";
const GREY: &str = "#777";
const PALE: &str = "#e4e4e4";
const BORDER: Stroke = Stroke { colour: TEXT, width: 1.0, dashes: "" };
const GRID: Stroke = Stroke { colour: PALE, width: 0.8, dashes: "" };

/// Width of a figure, and heights of what it is made of [px].
const WIDTH: f64 = 860.0;
const FRAME_HEIGHT: f64 = 210.0;
const HEAD: f64 = 22.0;
const LEGEND_ROW: f64 = 17.0;
const FOOT: f64 = 46.0;
/// Left of a frame: name and numbers of the vertical axis [px].
const LEFT: f64 = 72.0;
const RIGHT: f64 = 22.0;
const SMALL: f64 = 11.5;
const LARGE: f64 = 15.0;
/// Width of the sample of a line in a legend [px].
const SAMPLE: f64 = 30.0;

/// Distances of ticks aimed at, along x and y [px].
const BETWEEN_TICKS: [f64; 2] = [75.0, 42.0];

/// Marks on a line.
const MARKS: usize = 7;

/// Points that all curves of a figure share: they keep the file below a megabyte.
const POINTS: usize = 50_000;

/// Points of one curve: four in each column of pixels.
const POINTS_OF_CURVE: usize = 4000;

/// Space beyond the data, as a share of their spread.
const MARGIN: f64 = 0.05;

impl Look {
    fn stroke(self) -> Stroke {
        match self {
            Self::Line(k) | Self::Points(k) => {
                Stroke { colour: COLOURS[k % COLOURS.len()], width: 1.5, dashes: DASHES[k % DASHES.len()] }
            }
            Self::Pale(k) => Stroke { colour: COLOURS[k % COLOURS.len()], width: 0.6, dashes: "" },
            Self::Bound(k) => Stroke { colour: GREY, width: 1.1, dashes: BOUNDS[k % BOUNDS.len()] },
        }
    }

    fn shape(self) -> Option<Shape> {
        match self {
            Self::Line(k) | Self::Points(k) => Some(SHAPES[k % SHAPES.len()]),
            Self::Pale(_) | Self::Bound(_) => None,
        }
    }
}

impl Figure {
    /// The figure as SVG.
    pub fn svg(&self) -> String {
        let mut drawing = Drawing::default();
        let mut y = 8.0;
        for (text, size, bold) in [(&self.title, LARGE, true), (&self.subtitle, SMALL, false)] {
            for line in wrapped(text, WIDTH - 2.0 * RIGHT, size) {
                y += 1.3 * size;
                drawing.text([RIGHT, y], label(&line, size, Anchor::Start, bold));
            }
        }
        y += 10.0;
        let width = WIDTH / self.columns as f64;
        let curves: usize = self.panels.iter().map(|panel| panel.curves.len()).sum();
        let most = (POINTS / curves.max(1)).clamp(100, POINTS_OF_CURVE);
        for row in self.panels.chunks(self.columns) {
            let legend = row.iter().map(|panel| panel.legend(width).len()).max().unwrap_or(0) as f64 * LEGEND_ROW;
            for (k, panel) in row.iter().enumerate() {
                panel.draw(&mut drawing, [width * k as f64, y], width, legend, most);
            }
            y += HEAD + legend + FRAME_HEIGHT + FOOT;
        }
        drawing.finish([WIDTH, y.ceil()])
    }
}

/// Where the values of a panel are drawn.
struct Frame {
    x: Range,
    y: Range,
    /// upper left corner [px]
    corner: [f64; 2],
    width: f64,
}

impl Frame {
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top] = self.corner;
        [left + self.width * self.x.share(x), top + FRAME_HEIGHT * (1.0 - self.y.share(y))]
    }
}

impl Panel {
    /// Draw into a box of a given width whose upper left corner is at a place; the legend has a given height.
    fn draw(&self, drawing: &mut Drawing, [left, top]: [f64; 2], width: f64, legend: f64, most: usize) {
        let values =
            |k: usize| self.curves.iter().flat_map(move |curve| curve.points.iter().map(move |point| point[k]));
        let forward = |curve: &Curve| curve.points.windows(2).all(|pair| pair[0][0] <= pair[1][0]);
        let is_time = self.curves.iter().all(|curve| !matches!(curve.look, Look::Points(_)) && forward(curve));
        let frame = Frame {
            x: Range::of(&self.x, values(0), if is_time { 0.0 } else { MARGIN }),
            y: Range::of(&self.y, values(1), MARGIN),
            corner: [left + LEFT, top + HEAD + legend],
            width: width - LEFT - RIGHT,
        };
        // A line alone needs no marks.
        let marked = self.curves.iter().filter(|curve| curve.look.shape().is_some()).count() > 1;
        drawing.text([left + LEFT, top + HEAD - 9.0], label(&self.title, SMALL, Anchor::Start, true));
        for (row, names) in self.legend(width).iter().enumerate() {
            let y = top + HEAD + LEGEND_ROW * row as f64 + 2.0;
            names.iter().for_each(|(x, curve)| curve.draw_sample(drawing, [left + LEFT + x, y], marked));
        }
        self.draw_axes(drawing, &frame);
        let marks = if marked { MARKS } else { 0 };
        for (k, curve) in self.curves.iter().enumerate() {
            curve.draw(drawing, &frame, most, marks, (k as f64 + 0.5) / self.curves.len() as f64);
        }
        drawing.frame(frame.corner, [frame.width, FRAME_HEIGHT], BORDER);
    }

    fn draw_axes(&self, drawing: &mut Drawing, frame: &Frame) {
        let [left, top] = frame.corner;
        let (right, bottom) = (left + frame.width, top + FRAME_HEIGHT);
        let (ticks, name) = frame.x.ticks(&self.x, frame.width / BETWEEN_TICKS[0]);
        for tick in ticks {
            let x = left + frame.width * tick.share;
            drawing.line([x, top], [x, bottom], GRID);
            drawing.text([x, bottom + 15.0], label(&tick.label, SMALL, Anchor::Middle, false));
        }
        drawing.text([0.5 * (left + right), bottom + 32.0], label(&name, SMALL, Anchor::Middle, false));
        let (ticks, name) = frame.y.ticks(&self.y, FRAME_HEIGHT / BETWEEN_TICKS[1]);
        for tick in ticks {
            let y = bottom - FRAME_HEIGHT * tick.share;
            drawing.line([left, y], [right, y], GRID);
            drawing.text([left - 6.0, y + 4.0], label(&tick.label, SMALL, Anchor::End, false));
        }
        let upright = Label { upright: true, ..label(&name, SMALL, Anchor::Middle, false) };
        drawing.text([left - LEFT + 16.0, 0.5 * (top + bottom)], upright);
    }

    /// Rows of the legend, each name with its place along the row; none for a single curve.
    fn legend(&self, width: f64) -> Vec<Vec<(f64, &Curve)>> {
        let mut rows: Vec<Vec<(f64, &Curve)>> = Vec::new();
        if self.curves.len() < 2 {
            return rows;
        }
        let mut x = f64::INFINITY;
        for curve in self.curves.iter().filter(|curve| !curve.name.is_empty()) {
            let needed = SAMPLE + 6.0 + text_width(&curve.name, SMALL) + 14.0;
            if x + needed > width - LEFT {
                rows.push(Vec::new());
                x = 0.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, curve));
            }
            x += needed;
        }
        rows
    }
}

impl Curve {
    /// Draw the curve with no more than `most` points, its marks shifted by a share of their distance.
    fn draw(&self, drawing: &mut Drawing, frame: &Frame, most: usize, marks: usize, shift: f64) {
        let pieces = thin(self.points.iter().map(|point| frame.at(*point)), most);
        drawing.path(&pieces, self.look.stroke());
        let Some(shape) = self.look.shape() else { return };
        let places = match self.look {
            Look::Points(_) => pieces.concat(),
            _ => spread(&pieces.concat(), marks, shift),
        };
        places.into_iter().for_each(|place| drawing.mark(place, shape, self.look.stroke().colour));
    }

    /// Draw the line of the legend, with the name beside it.
    fn draw_sample(&self, drawing: &mut Drawing, [x, y]: [f64; 2], marked: bool) {
        let stroke = self.look.stroke();
        drawing.line([x, y], [x + SAMPLE, y], stroke);
        if let Some(shape) = self.look.shape().filter(|_| marked) {
            drawing.mark([x + 0.5 * SAMPLE, y], shape, stroke.colour);
        }
        drawing.text([x + SAMPLE + 6.0, y + 4.0], label(&self.name, SMALL, Anchor::Start, false));
    }
}

/// Places for marks: evenly along x for a function of x, along the way for any other curve.
fn spread(points: &[[f64; 2]], marks: usize, shift: f64) -> Vec<[f64; 2]> {
    let is_function = points.windows(2).all(|pair| pair[0][0] <= pair[1][0]);
    let step = |a: &[f64; 2], b: &[f64; 2]| if is_function { b[0] - a[0] } else { (b[0] - a[0]).hypot(b[1] - a[1]) };
    let total: f64 = points.windows(2).map(|pair| step(&pair[0], &pair[1])).sum();
    let mut places = Vec::new();
    let (mut way, mut next) = (0.0, shift * total / marks as f64);
    for pair in points.windows(2) {
        let length = step(&pair[0], &pair[1]);
        while length > 0.0 && way + length > next && places.len() < marks {
            let share = (next - way) / length;
            places.push([0, 1].map(|i| pair[0][i] + share * (pair[1][i] - pair[0][i])));
            next += total / marks as f64;
        }
        way += length;
    }
    places
}

fn label(text: &str, size: f64, anchor: Anchor, bold: bool) -> Label<'_> {
    Label { text, size, anchor, bold, upright: false }
}

/// Lines of a text that fit into a width.
fn wrapped(text: &str, width: f64, size: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(line, size) + text_width(word, size) < width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}
