//! SVG pictures of lines, nodes, bodies and labels.
//!
//! Lines and letters take the colour of the surrounding text, so that pictures are legible on light and dark pages. y
//! points down.

use std::fmt::Write;

/// Colour of masters, or of the first body or node.
pub const BLUE: &str = "#2f7fd0";
/// Colour of slaves, or of the second body or node.
pub const ORANGE: &str = "#d9691e";
/// Width and height of every picture.
pub const SIZE: [f64; 2] = [320.0, 170.0];

pub type At = [f64; 2];

/// A picture of one constraint type, named after the file of its page.
pub struct Picture {
    pub name: &'static str,
    title: &'static str,
    body: String,
}

impl Picture {
    /// An empty picture. Screen readers read the title.
    pub fn new(name: &'static str, title: &'static str) -> Self {
        Self { name, title, body: String::new() }
    }

    /// Contents of the file, without empty lines: in Markdown these would end the picture.
    pub fn svg(&self) -> String {
        let ([width, height], body) = (SIZE, &self.body);
        let head = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\"");
        let view =
            format!("viewBox=\"0 0 {width} {height}\" role=\"img\" font-family=\"sans-serif\" font-size=\"14\">");
        format!("{head} {view}\n<title>{}</title>\n{body}</svg>\n", self.title)
    }

    fn put(mut self, element: &str) -> Self {
        self.body.push_str(element);
        self.body.push('\n');
        self
    }

    fn path(self, data: &str, style: &str) -> Self {
        self.put(&format!("<path d=\"{data}\" {style}/>"))
    }

    /// A thin line in the colour of the text.
    pub fn line(self, points: &[At]) -> Self {
        self.path(&through(points), "fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.5\"")
    }

    /// A thin dashed line, for something imaginary or in its former position.
    pub fn dashed(self, points: &[At]) -> Self {
        let style = "fill=\"none\" stroke=\"currentColor\" stroke-width=\"1\" stroke-dasharray=\"5 4\" opacity=\"0.7\"";
        self.path(&through(points), style)
    }

    /// A thick coloured line: a rod, or an edge of a mesh.
    pub fn bar(self, points: &[At], colour: &str) -> Self {
        let style = format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"3\" stroke-linejoin=\"round\"");
        self.path(&through(points), &style)
    }

    /// A filled polygon with an outline of the same colour.
    pub fn area(self, corners: &[At], colour: &str) -> Self {
        let style = format!("fill=\"{colour}\" fill-opacity=\"0.2\" stroke=\"{colour}\" stroke-width=\"1.5\"");
        self.path(&(through(corners) + " Z"), &style)
    }

    /// A body: a rectangle about a centre, rotated by an angle in degrees.
    pub fn body(self, centre: At, [width, height]: At, angle: f64, colour: &str) -> Self {
        let corner = |x: f64, y: f64| add(centre, polar_sum(x * width / 2.0, y * height / 2.0, angle));
        self.area(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], colour)
    }

    /// An arrow.
    pub fn arrow(self, from: At, to: At) -> Self {
        let (along, length) = direction(from, to);
        let back = [to[0] - 9.0 * along[0], to[1] - 9.0 * along[1]];
        let side = |s: f64| [back[0] - s * along[1], back[1] + s * along[0]];
        let head = format!("{} Z", through(&[to, side(4.0), side(-4.0)]));
        let picture = if length > 9.0 { self.line(&[from, back]) } else { self };
        picture.path(&head, "fill=\"currentColor\"")
    }

    /// An arrow with heads at both ends.
    pub fn both_ways(self, from: At, to: At) -> Self {
        let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
        self.arrow(middle, from).arrow(middle, to)
    }

    /// A circular arrow; angles in degrees, from x towards y.
    pub fn turn(self, centre: At, radius: f64, from: f64, to: f64) -> Self {
        let picture = self.line(&arc(centre, radius, from, to));
        let end = add(centre, polar(radius, to));
        let tangent = polar(9.0, to + if to > from { 90.0 } else { -90.0 });
        picture.arrow(end, add(end, tangent))
    }

    /// A coloured node.
    pub fn node(self, [x, y]: At, colour: &str) -> Self {
        self.put(&format!("<circle cx=\"{}\" cy=\"{}\" r=\"5\" fill=\"{colour}\"/>", short(x), short(y)))
    }

    /// A ring: a pin, a ball, or an axis seen from its end.
    pub fn ring(self, [x, y]: At, radius: f64) -> Self {
        let style = "fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.5\"";
        self.put(&format!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {style}/>", short(x), short(y), short(radius)))
    }

    /// Ground: a line with hatching below it.
    pub fn ground(self, [x, y]: At, width: f64) -> Self {
        let (left, right) = (x - width / 2.0, x + width / 2.0);
        let strokes = (1..=(width / 10.0) as usize).map(|k| left + 10.0 * k as f64);
        strokes.fold(self.line(&[[left, y], [right, y]]), |p, x| p.line(&[[x, y], [x - 8.0, y + 8.0]]))
    }

    /// Centred text; letters between `_` and the next blank are a subscript.
    pub fn label(self, [x, y]: At, text: &str) -> Self {
        let (mut spans, mut below) = (String::new(), false);
        for (k, word) in text.split(' ').enumerate() {
            let blank = if k == 0 { "" } else { " " };
            let (main, index) = word.split_once('_').unwrap_or((word, ""));
            let raise = if below { " dy=\"-4\"" } else { "" };
            let _ = write!(spans, "<tspan{raise}>{blank}{main}</tspan>");
            below = !index.is_empty();
            if below {
                let _ = write!(spans, "<tspan dy=\"4\" font-size=\"10\">{index}</tspan>");
            }
        }
        let place = format!("x=\"{}\" y=\"{}\"", short(x), short(y + 5.0));
        self.put(&format!("<text {place} text-anchor=\"middle\" fill=\"currentColor\">{spans}</text>"))
    }
}

/// `M x y L x y ...`.
fn through(points: &[At]) -> String {
    let step = |(k, [x, y]): (usize, &At)| format!("{}{} {}", if k == 0 { "M" } else { " L" }, short(*x), short(*y));
    points.iter().enumerate().map(step).collect()
}

/// Rounds to a tenth, so that files are the same on every machine.
fn short(x: f64) -> String {
    let tenths = (10.0 * x).round() / 10.0;
    format!("{}", if tenths == 0.0 { 0.0 } else { tenths })
}

fn direction(from: At, to: At) -> (At, f64) {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let length = x.hypot(y);
    ([x / length, y / length], length)
}

pub fn add(a: At, b: At) -> At {
    [a[0] + b[0], a[1] + b[1]]
}

/// The point with these polar coordinates; the angle is in degrees.
pub fn polar(radius: f64, angle: f64) -> At {
    let (sin, cos) = angle.to_radians().sin_cos();
    [radius * cos, radius * sin]
}

fn polar_sum(x: f64, y: f64, angle: f64) -> At {
    add(polar(x, angle), polar(y, angle + 90.0))
}

/// Points of an arc.
pub fn arc(centre: At, radius: f64, from: f64, to: f64) -> Vec<At> {
    (0..=24).map(|k| add(centre, polar(radius, from + (to - from) * f64::from(k) / 24.0))).collect()
}
