//! Text of a drive, made fit for terminals and files.

/// Escapes the characters of a foreign text that a terminal or a reader would not show as they are: control characters, and
/// with them ANSI sequences, marks that change the direction of the text, and everything else without a glyph, as `\u{..}`.
///
/// Every text of a drive or of its process passes here before it is printed or written.
#[must_use]
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '"' | '\'' | '\\' => shown.push(character),
            _ => shown.extend(character.escape_debug()),
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_with_glyphs_is_kept() {
        for text in ["N m/rad", "gap \"j0\" \\ 'x'", "Übersetzung 1:3 µm 回転"] {
            assert_eq!(printable(text), text);
        }
    }

    #[test]
    fn what_controls_a_terminal_or_a_reader_is_escaped() {
        for (text, shown) in [
            ("\u{1b}[2Jx", r"\u{1b}[2Jx"),
            ("\u{9b}31mx", r"\u{9b}31mx"),
            ("a\r\nb\tc\u{7f}\0", r"a\r\nb\tc\u{7f}\0"),
            ("\u{202e}mn\u{2066}\u{200f}", r"\u{202e}mn\u{2066}\u{200f}"),
            ("a\u{200b}b\u{feff}\u{2028}\u{e0041}", r"a\u{200b}b\u{feff}\u{2028}\u{e0041}"),
        ] {
            assert_eq!(printable(text), shown);
        }
    }
}
