//! An SVG drawing: lines, marks and text at places in pixels.

use std::fmt::Write;

use crate::mesh::names::is_unwritable;

/// By this a figure of ours is known.
pub const OURS: &str = "data-drawn-by=\"fecontact\"";

/// A drawing in progress.
#[derive(Debug, Default)]
pub struct Drawing(String);

/// Colour, width and dashes of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// colour
    pub colour: &'static str,
    /// width [px]
    pub width: f64,
    /// dashes and gaps [px]; empty for a solid line
    pub dashes: &'static str,
}

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// ○
    Circle,
    /// □
    Square,
    /// △
    Triangle,
    /// ◇
    Diamond,
    /// ×
    Cross,
}

/// Where a text stands relative to its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// begins there
    Start,
    /// is centred there
    Middle,
    /// ends there
    End,
}

/// A text and how it looks.
#[derive(Clone, Copy, Debug)]
pub struct Label<'a> {
    /// the words
    pub text: &'a str,
    /// size of the letters [px]
    pub size: f64,
    /// position relative to the place
    pub anchor: Anchor,
    /// bold letters
    pub bold: bool,
    /// turned by −90°, to be read upwards
    pub upright: bool,
}

/// Half the size of a mark [px].
const MARK: f64 = 3.2;

/// Mean width of a letter as a share of its height.
const LETTER: f64 = 0.55;

/// The width a text will have, about [px].
pub fn text_width(text: &str, size: f64) -> f64 {
    LETTER * size * text.chars().count() as f64
}

// Writing to a String cannot fail: results of `write!` are dropped throughout.
impl Drawing {
    /// A line through the points of each piece; one with a point that has no place is left out.
    pub fn path(&mut self, pieces: &[Vec<[f64; 2]>], stroke: Stroke) {
        let placed = |piece: &&Vec<[f64; 2]>| piece.as_flattened().iter().all(|x| x.is_finite());
        if pieces.iter().filter(placed).all(Vec::is_empty) {
            return;
        }
        let _ = write!(self.0, "<path fill=\"none\" {}", attributes(stroke));
        self.0 += " d=\"";
        for piece in pieces.iter().filter(placed) {
            for (k, [x, y]) in piece.iter().enumerate() {
                let _ = write!(self.0, "{}{x:.1},{y:.1}", if k == 0 { 'M' } else { ' ' });
            }
        }
        self.0 += "\"/>\n";
    }

    /// A straight line.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.path(&[vec![from, to]], stroke);
    }

    /// A rectangle without filling.
    pub fn frame(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], stroke: Stroke) {
        let attributes = attributes(stroke);
        let _ = writeln!(
            self.0,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" {attributes}/>"
        );
    }

    /// A filled rectangle.
    pub fn fill(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], colour: &str) {
        let _ = writeln!(
            self.0,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\" \
             shape-rendering=\"crispEdges\"/>"
        );
    }

    /// Filled rectangles of one colour, each with its upper left and its lower right corner.
    pub fn fill_all(&mut self, rectangles: &[[[f64; 2]; 2]], colour: &str) {
        let _ = write!(self.0, "<path fill=\"{colour}\" shape-rendering=\"crispEdges\" d=\"");
        // Corners are rounded, not sizes: no gaps open between neighbours.
        let round = |x: f64| (10.0 * x).round() / 10.0;
        for [[left, top], [right, bottom]] in rectangles {
            let (width, height) = (round(*right) - round(*left), round(*bottom) - round(*top));
            let _ = write!(self.0, "M{left:.1},{top:.1}h{width:.1}v{height:.1}h{:.1}z", -width);
        }
        self.0 += "\"/>\n";
    }

    /// A mark.
    pub fn mark(&mut self, [x, y]: [f64; 2], shape: Shape, colour: &str) {
        let style = format!("fill=\"white\" stroke=\"{colour}\" stroke-width=\"1.2\"");
        let polygon = |corners: &[[f64; 2]]| {
            let corners: Vec<String> =
                corners.iter().map(|[i, j]| format!("{:.1},{:.1}", x + MARK * i, y + MARK * j)).collect();
            format!("<polygon points=\"{}\" {style}/>\n", corners.join(" "))
        };
        self.0 += &match shape {
            Shape::Circle => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARK}\" {style}/>\n"),
            Shape::Square => polygon(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
            Shape::Triangle => polygon(&[[-1.1, 0.9], [1.1, 0.9], [0.0, -1.2]]),
            Shape::Diamond => polygon(&[[-1.2, 0.0], [0.0, -1.2], [1.2, 0.0], [0.0, 1.2]]),
            Shape::Cross => polygon(&[[-1.0, -1.0], [1.0, 1.0], [0.0, 0.0], [-1.0, 1.0], [1.0, -1.0], [0.0, 0.0]]),
        };
    }

    /// A text; its baseline is at the place.
    pub fn text(&mut self, [x, y]: [f64; 2], label: Label) {
        let Label { text, size, anchor, bold, upright } = label;
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if bold { " font-weight=\"bold\"" } else { "" };
        let turn = if upright { format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"") } else { String::new() };
        let text = escaped(text);
        let _ = writeln!(
            self.0,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\"{weight}{turn}>{text}</text>"
        );
    }

    /// The finished file.
    pub fn finish(self, [width, height]: [f64; 2]) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
             {height}\" font-family=\"Helvetica, Arial, DejaVu Sans, sans-serif\" fill=\"#222\" \
             {OURS}>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
            self.0
        )
    }
}

fn attributes(Stroke { colour, width, dashes }: Stroke) -> String {
    let dashes = if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
    format!("stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dashes}")
}

fn escaped(text: &str) -> String {
    let text = text.replace(is_unwritable, "\u{fffd}");
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
