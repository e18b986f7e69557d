//! Text of a drive, made fit for terminals and files.

use std::borrow::Cow;

/// A number and its noun: "1 byte", "25 frames of this bench".
#[must_use]
pub fn counted(count: u64, noun: &str) -> String {
    // The noun ends before its preposition.
    let end = [" of ", " with "].iter().find_map(|preposition| noun.find(preposition)).unwrap_or(noun.len());
    let (head, tail) = noun.split_at(end);
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {head}{plural}{tail}")
}

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

/// As [`printable`], for whole outputs: lines and tabs stay, and so does what has no glyph and controls nothing.
#[must_use]
pub fn without_controls(text: &str) -> Cow<'_, str> {
    if !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if is_control(character) { shown.extend(character.escape_unicode()) } else { shown.push(character) }
    }
    Cow::Owned(shown)
}

/// Whether a terminal acts on a character instead of showing it: control characters, marks of the direction of the text.
#[must_use]
pub fn is_control(character: char) -> bool {
    let is_of_direction = |it| matches!(it, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    (character.is_control() && !"\n\t".contains(character)) || is_of_direction(character)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_keeps_its_lines_and_no_control() {
        assert_eq!(without_controls("a\tb\nµ \u{301}\n"), "a\tb\nµ \u{301}\n");
        assert_eq!(without_controls("\u{1b}[2J\r\u{9b}1m\u{202e}"), r"\u{1b}[2J\u{d}\u{9b}1m\u{202e}");
    }

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
