//! Figures as PNG.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, fontdb};

/// Pixels per pixel of the figure: text stays sharp on paper and on dense screens.
const SCALE: f32 = 2.0;
/// The generic family in the order of preference, by what distributions install.
const SANS_SERIF: [&str; 4] = ["Liberation Sans", "Arial", "DejaVu Sans", "Noto Sans"];

/// Why a figure can't be drawn as PNG.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PngError {
    /// No font for the text.
    #[error(
        "there is no font on this system, so the text can't be drawn: install one such as fonts-dejavu-core, or write .svg"
    )]
    NoFont,
    /// Not a figure.
    #[error("the figure can't be read: {0}")]
    Svg(#[from] usvg::Error),
    /// A figure of no size, or of too large a one.
    #[error("a picture of {width} x {height} pixels can't be drawn; plot fewer panels")]
    Size {
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
    },
    /// The encoder failed.
    #[error("the picture can't be encoded: {0}")]
    Encode(String),
}

/// Draws an SVG document of a figure, with the fonts of this system.
///
/// # Errors
/// The system has no font, or the figure is too large.
pub(super) fn from_svg(svg: &str) -> Result<Vec<u8>, PngError> {
    let mut fonts = fontdb::Database::new();
    fonts.load_system_fonts();
    let has =
        |family: &&&str| fonts.faces().any(|face| face.families.iter().any(|(name, _)| name == **family));
    let installed = SANS_SERIF.iter().find(has).map(|family| (*family).to_owned());
    let any = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
    let family = installed.or(any).ok_or(PngError::NoFont)?;
    fonts.set_sans_serif_family(&family);
    let options = usvg::Options { fontdb: Arc::new(fonts), font_family: family, ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let (width, height) = size.map_or((0, 0), |size| (size.width(), size.height()));
    let mut pixels = Pixmap::new(width, height).ok_or(PngError::Size { width, height })?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| PngError::Encode(error.to_string()))
}

#[cfg(test)]
mod tests {
    use lashloop_plot::{Axis, Figure, Panel, Role, Series};

    use super::*;

    #[test]
    fn a_picture_has_the_size_of_its_figure_twice_and_ink_in_its_text() {
        let panel = Panel::new("panel", Axis::new("time", "s"), Axis::new("torque", "N m"));
        let line = Series::new("run", Role::After, vec![0.0, 1.0], vec![0.0, 1.0]);
        let svg = Figure::new("title", "", 1).panel(panel.series(line)).to_svg();
        let picture = Pixmap::decode_png(&from_svg(&svg).expect("a picture")).expect("a PNG");
        let size = |name: &str| -> f64 {
            let rest = svg.split_once(&format!(" {name}=\"")).expect("a size").1;
            rest.split_once('"').and_then(|(number, _)| number.parse().ok()).expect("a number")
        };
        assert_eq!(f64::from(picture.width()), (2.0 * size("width")).round());
        assert!((f64::from(picture.height()) - 2.0 * size("height")).abs() <= 2.0);
        // The title is bold ink at the upper left.
        let dark = |x: u32, y: u32| picture.pixel(x, y).is_some_and(|pixel| pixel.red() < 100);
        let ink =
            (40..200).flat_map(|x| (40..100).map(move |y| (x, y))).filter(|(x, y)| dark(*x, *y)).count();
        assert!(ink > 100, "{ink} dark pixels");
    }
}
