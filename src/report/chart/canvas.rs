//! A drawing sheet in pixels, and text measures.

use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, IntoFont, RGBAColor, RGBColor, ShapeStyle, TextStyle};

/// The backend draws on whole units: this many make a pixel.
const UNITS: f64 = 4.0;
/// `plotters` writes a font smaller than requested by this factor.
const FONT_SCALE: f64 = 1.24;

pub(super) type Color = RGBColor;
pub(super) const INK: Color = RGBColor(0x22, 0x22, 0x22);
pub(super) const FAINT: Color = RGBColor(0x55, 0x55, 0x55);
pub(super) const RULE: Color = RGBColor(0xdd, 0xdd, 0xdd);
pub(super) const WHITE: Color = RGBColor(0xff, 0xff, 0xff);
pub(super) const GREEN: Color = RGBColor(0x00, 0x9e, 0x73);
pub(super) const ORANGE: Color = RGBColor(0xe6, 0x9f, 0x00);
pub(super) const VERMILION: Color = RGBColor(0xd5, 0x5e, 0x00);
/// The colours of Okabe and Ito that are visible on white.
pub(super) const PALETTE: [Color; 7] = [
    RGBColor(0x00, 0x72, 0xb2),
    VERMILION,
    GREEN,
    RGBColor(0xcc, 0x79, 0xa7),
    ORANGE,
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0x00, 0x00, 0x00),
];

/// The n-th colour, cyclic.
pub(super) fn color(n: usize) -> Color {
    PALETTE[n % PALETTE.len()]
}

/// The same hue, dark enough for small letters.
pub(super) fn dark(c: Color) -> Color {
    let part = |v: u8| (f64::from(v) * 0.68) as u8;
    RGBColor(part(c.0), part(c.1), part(c.2))
}

/// The style of a line.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    pub color: Color,
    pub width: f64,
    pub alpha: f64,
    /// Drawn and skipped lengths of a dashed line, in pixels.
    pub dash: Option<(f64, f64)>,
}

impl Pen {
    pub fn new(color: Color, width: f64) -> Self {
        Self { color, width, alpha: 1.0, dash: None }
    }

    pub fn alpha(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }

    pub fn dashed(self, on: f64, off: f64) -> Self {
        Self { dash: Some((on, off)), ..self }
    }

    fn style(&self) -> ShapeStyle {
        let RGBColor(r, g, b) = self.color;
        ShapeStyle {
            color: RGBAColor(r, g, b, self.alpha),
            filled: false,
            stroke_width: (self.width * UNITS).round().max(1.0) as u32,
        }
    }
}

/// The side of a text where its point is.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// The style of a text; its point is half-way up the letters.
#[derive(Clone, Copy)]
pub(super) struct Font {
    pub size: f64,
    pub bold: bool,
    pub color: Color,
    pub anchor: Anchor,
    /// Turned a quarter anticlockwise, so that it reads upwards.
    pub upright: bool,
}

impl Font {
    pub fn new(size: f64, color: Color) -> Self {
        Self { size, bold: false, color, anchor: Anchor::Start, upright: false }
    }

    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub fn upright(self) -> Self {
        Self { upright: true, ..self }
    }

    /// The width of a text in pixels, an upper estimate for common sans-serif fonts.
    pub fn width(&self, text: &str) -> f64 {
        let em: f64 = text.chars().map(advance).sum();
        em * self.size * if self.bold { 1.12 } else { 1.0 }
    }

    /// Wraps a text at spaces into lines of at most `width`.
    pub fn wrap(&self, text: &str, width: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if self.width(line) + self.width(" ") + self.width(word) <= width => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.to_owned()),
            }
        }
        lines
    }
}

/// The advance of a letter as a fraction of the font size.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'l' | 'j' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.33,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' | ' ' => 0.40,
        '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' => 0.43,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.97,
        'A'..='Z' | '≤' | '≥' | '×' | '+' | '=' | '<' | '>' | '~' | '±' => 0.78,
        _ if c.is_ascii() => 0.63,
        _ => 0.8,
    }
}

/// The shape of a mark.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Mark {
    Circle,
    Square,
    Triangle,
    Diamond,
    Down,
    Cross,
}

const MARKS: [Mark; 6] = [Mark::Circle, Mark::Square, Mark::Triangle, Mark::Diamond, Mark::Down, Mark::Cross];

/// The n-th mark, cyclic; with [`color`] it gives 42 different pairs.
pub(super) fn mark(n: usize) -> Mark {
    MARKS[n % MARKS.len()]
}

/// A sheet of white paper, measured in pixels from its upper left corner.
pub(super) struct Canvas<'a> {
    backend: SVGBackend<'a>,
}

/// Draws on a sheet and returns it as an SVG document. Screen readers say `name`.
pub(super) fn sheet(width: f64, height: f64, name: &str, draw: impl FnOnce(&mut Canvas<'_>)) -> String {
    let size = (units(width) as u32, units(height) as u32);
    let mut body = String::new();
    {
        let mut canvas = Canvas { backend: SVGBackend::with_string(&mut body, size) };
        canvas.rect((0.0, 0.0), (width, height), WHITE, 1.0);
        draw(&mut canvas);
        written(canvas.backend.present());
    }
    let body = body.split_once('\n').map_or("", |(_, rest)| rest);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {} {}\" stroke-linejoin=\"round\" role=\"img\">\n<title>{}</title>\n{body}",
        size.0,
        size.1,
        escaped(name),
    )
}

impl Canvas<'_> {
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), pen: &Pen) {
        match pen.dash {
            None => written(self.backend.draw_line(point(from), point(to), &pen.style())),
            Some(_) => self.path(&[from, to], pen),
        }
    }

    pub fn path(&mut self, points: &[(f64, f64)], pen: &Pen) {
        let Some((on, off)) = pen.dash else {
            let points: Vec<_> = points.iter().map(|&p| point(p)).collect();
            written(self.backend.draw_path(points, &pen.style()));
            return;
        };
        for piece in dashes(points, on, off) {
            let piece: Vec<_> = piece.into_iter().map(point).collect();
            written(self.backend.draw_path(piece, &pen.style()));
        }
    }

    pub fn polygon(&mut self, points: &[(f64, f64)], fill: Color, alpha: f64) {
        let points: Vec<_> = points.iter().map(|&p| point(p)).collect();
        written(self.backend.fill_polygon(points, &Pen::new(fill, 0.0).alpha(alpha).style()));
    }

    pub fn rect(&mut self, at: (f64, f64), size: (f64, f64), fill: Color, alpha: f64) {
        let end = (at.0 + size.0, at.1 + size.1);
        let style = Pen::new(fill, 0.0).alpha(alpha).style();
        written(self.backend.draw_rect(point(at), point(end), &style, true));
    }

    pub fn ring(&mut self, at: (f64, f64), radius: f64, pen: &Pen) {
        let radius = units(radius).max(1) as u32;
        written(self.backend.draw_circle(point(at), radius, &pen.style(), false));
    }

    pub fn mark(&mut self, mark: Mark, at: (f64, f64), r: f64, fill: Color) {
        let (x, y) = at;
        let around = |offsets: &[(f64, f64)]| -> Vec<(f64, f64)> {
            offsets.iter().map(|o| (x + o.0 * r, y + o.1 * r)).collect()
        };
        match mark {
            Mark::Circle => {
                let style = Pen::new(fill, 0.0).style();
                let radius = units(r).max(1) as u32;
                written(self.backend.draw_circle(point(at), radius, &style, true));
            }
            Mark::Square => self.rect((x - 0.9 * r, y - 0.9 * r), (1.8 * r, 1.8 * r), fill, 1.0),
            Mark::Triangle => {
                self.polygon(&around(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)]), fill, 1.0);
            }
            Mark::Down => {
                self.polygon(&around(&[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)]), fill, 1.0);
            }
            Mark::Diamond => {
                let corners = [(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)];
                self.polygon(&around(&corners), fill, 1.0);
            }
            Mark::Cross => {
                let pen = Pen::new(fill, 0.55 * r);
                self.path(&around(&[(-0.95, -0.95), (0.95, 0.95)]), &pen);
                self.path(&around(&[(-0.95, 0.95), (0.95, -0.95)]), &pen);
            }
        }
    }

    pub fn text(&mut self, text: &str, at: (f64, f64), font: &Font) {
        let mut face = ("sans-serif", font.size * UNITS * FONT_SCALE).into_font();
        if font.bold {
            face = face.style(plotters::style::FontStyle::Bold);
        }
        if font.upright {
            face = face.transform(FontTransform::Rotate270);
        }
        let side = match font.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let style = TextStyle::from(face).color(&font.color).pos(Pos::new(side, VPos::Center));
        written(self.backend.draw_text(&printable(text), &style, point(at)));
    }
}

/// Writing to a string cannot fail.
fn written<E: std::fmt::Debug>(result: Result<(), E>) {
    debug_assert!(result.is_ok(), "{result:?}");
}

fn units(pixels: f64) -> i32 {
    (pixels * UNITS).round() as i32
}

fn point((x, y): (f64, f64)) -> (i32, i32) {
    (units(x), units(y))
}

/// A text without the characters that XML forbids.
fn printable(text: &str) -> String {
    let plain = |c: char| {
        if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { ' ' } else { c }
    };
    text.chars().map(plain).collect()
}

fn escaped(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Cuts a path into dashes.
fn dashes(points: &[(f64, f64)], on: f64, off: f64) -> Vec<Vec<(f64, f64)>> {
    let mut pieces = Vec::new();
    let mut piece = points.first().map_or_else(Vec::new, |&p| vec![p]);
    let (mut drawing, mut left) = (true, on);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut length = (to.0 - from.0).hypot(to.1 - from.1);
        while length > left {
            let part = left / length;
            from = (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part);
            length -= left;
            if drawing {
                piece.push(from);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![from];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
        left -= length;
        if drawing {
            piece.push(to);
        }
    }
    if drawing && piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}
