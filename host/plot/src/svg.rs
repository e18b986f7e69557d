//! The document: elements with escaped text.

use std::fmt::{Display, Write};

use super::scale::Point;
use super::theme;
use crate::xml::Escaped;

/// Where a text is anchored horizontally.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// One line of text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label<'a> {
    pub(super) text: &'a str,
    pub(super) x: f64,
    /// Height of the baseline.
    pub(super) y: f64,
    pub(super) size_px: f64,
    pub(super) colour: &'a str,
    pub(super) anchor: Anchor,
    pub(super) bold: bool,
}

impl<'a> Label<'a> {
    /// Plain text at the size of labels, at the origin.
    pub(super) fn new(text: &'a str) -> Self {
        let (size_px, colour) = (theme::LABEL_PX, theme::INK);
        Self { text, x: 0.0, y: 0.0, size_px, colour, anchor: Anchor::Start, bold: false }
    }
}

/// An SVG document being written.
#[derive(Debug)]
pub(super) struct Svg {
    document: String,
}

impl Svg {
    /// Opens a document of a size in pixels, with title and description for screen readers.
    pub(super) fn open(width: f64, height: f64, title: &str, description: &str) -> Self {
        let (width, height) = (Px(width), Px(height));
        let mut svg = Self { document: String::new() };
        svg.line(format_args!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="{}">"#,
            theme::FONT
        ));
        svg.line(format_args!("<title>{}</title>", Escaped(title)));
        svg.line(format_args!("<desc>{}</desc>", Escaped(description)));
        svg
    }

    /// Closes the document.
    pub(super) fn close(mut self) -> String {
        self.document.push_str("</svg>\n");
        self.document
    }

    /// A filled rectangle with round corners; `outline` is its colour.
    pub(super) fn rectangle(
        &mut self,
        (x, y): Point,
        (width, height): (f64, f64),
        fill: &str,
        outline: Option<&str>,
    ) {
        let (x, y, width, height) = (Px(x), Px(y), Px(width), Px(height));
        let outline = outline.map(|colour| format!(r#" rx="8" stroke="{colour}""#)).unwrap_or_default();
        self.line(format_args!(
            r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}"{outline}/>"#
        ));
    }

    /// Straight lines of one colour, each from one point to another.
    pub(super) fn lines(&mut self, lines: &[[Point; 2]], colour: &str, width_px: f64) {
        let mut data = String::new();
        for [(x1, y1), (x2, y2)] in lines {
            write!(data, "M{} {}L{} {}", Px(*x1), Px(*y1), Px(*x2), Px(*y2))
                .expect("writing to a string succeeds");
        }
        self.line(format_args!(r#"<path d="{data}" stroke="{colour}" stroke-width="{width_px}"/>"#));
    }

    /// A curve; viewers show its name under the pointer.
    pub(super) fn curve(&mut self, data: &str, pen: theme::Pen, name: Option<&str>) {
        let theme::Pen { colour, width_px, dash } = pen;
        let dash = dash.map(|dash| format!(r#" stroke-dasharray="{dash}""#)).unwrap_or_default();
        let name = name.map(|name| format!("<title>{}</title>", Escaped(name))).unwrap_or_default();
        self.line(format_args!(
            r#"<path d="{data}" fill="none" stroke="{colour}" stroke-width="{width_px}" stroke-linejoin="round" stroke-linecap="round"{dash}>{name}</path>"#
        ));
    }

    /// An area within an outline, in a colour that lets grid and curves show through.
    pub(super) fn shade(&mut self, data: &str, colour: &str) {
        self.line(format_args!(r#"<path d="{data}Z" fill="{colour}" fill-opacity="0.15"/>"#));
    }

    /// A ring around a point.
    pub(super) fn ring(&mut self, (x, y): Point, radius_px: f64, colour: &str) {
        let (x, y) = (Px(x), Px(y));
        self.line(format_args!(
            r#"<circle cx="{x}" cy="{y}" r="{radius_px}" fill="{}" stroke="{colour}" stroke-width="2"/>"#,
            theme::GROUND
        ));
    }

    /// A line of text.
    pub(super) fn text(&mut self, label: Label) {
        let position = format!(r#"x="{}" y="{}""#, Px(label.x), Px(label.y));
        self.write_text(label, &position);
    }

    /// Lines of text below the position of `style`, at this spacing in font sizes.
    pub(super) fn paragraph(&mut self, lines: &[String], spacing: f64, style: Label) {
        for (index, text) in lines.iter().enumerate() {
            let y = style.y + style.size_px + index as f64 * style.size_px * spacing;
            self.text(Label { text, y, ..style });
        }
    }

    /// A line of text that reads from bottom to top.
    pub(super) fn upright_text(&mut self, label: Label) {
        let position = format!(r#"transform="translate({} {}) rotate(-90)""#, Px(label.x), Px(label.y));
        self.write_text(label, &position);
    }

    fn write_text(&mut self, label: Label, position: &str) {
        let Label { text, size_px, colour, anchor, bold, .. } = label;
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => r#" text-anchor="middle""#,
            Anchor::End => r#" text-anchor="end""#,
        };
        let weight = if bold { r#" font-weight="bold""# } else { "" };
        self.line(format_args!(
            r#"<text {position} font-size="{size_px}" fill="{colour}"{anchor}{weight}>{}</text>"#,
            Escaped(text)
        ));
    }

    fn line(&mut self, element: std::fmt::Arguments) {
        self.document.write_fmt(element).expect("writing to a string succeeds");
        self.document.push('\n');
    }
}

/// A coordinate to a tenth of a pixel.
struct Px(f64);

impl Display for Px {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        // Adding zero turns a rounded minus zero into plain zero.
        write!(formatter, "{}", (self.0 * 10.0).round() / 10.0 + 0.0)
    }
}
