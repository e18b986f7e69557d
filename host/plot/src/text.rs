//! Estimated width of text, and line breaks.
//!
//! The viewer selects the font, so a width is an estimate. We assume wide fonts: an overestimate leaves space, an
//! underestimate overlaps.

/// Estimated width of a line of text at a font size, both in pixels.
pub(super) fn width_px(text: &str, size_px: f64) -> f64 {
    text.chars().map(em).sum::<f64>() * size_px
}

fn em(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' => 0.33,
        't' | 'f' | 'r' | '(' | ')' | '-' | '/' => 0.41,
        'm' | 'w' | 'M' | 'W' => 0.92,
        'A'..='Z' => 0.7,
        '0'..='9' => 0.64,
        '\u{2212}' | '\u{2192}' | '\u{b1}' => 0.84,
        _ => 0.61,
    }
}

/// Breaks text at spaces into lines of at most `width_px`, and at line feeds. A longer word stays in one piece.
pub(super) fn wrap(text: &str, size_px: f64, limit_px: f64) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split(' ').filter(|word| !word.is_empty()) {
            if !line.is_empty()
                && width_px(&line, size_px) + width_px(word, size_px) + width_px(" ", size_px) > limit_px
            {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    lines
}

/// An integer exponent in superscript digits.
pub(super) fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    exponent
        .to_string()
        .chars()
        .map(|character| character.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_at_spaces_and_keep_every_word() {
        let text = "the quick brown fox jumps over the lazy dog\nand rests";
        let lines = wrap(text, 10.0, 100.0);
        assert!(lines.len() > 3, "{lines:?}");
        assert!(lines.iter().all(|line| width_px(line, 10.0) <= 100.0), "{lines:?}");
        assert_eq!(lines.join(" "), text.replace('\n', " "));
        assert_eq!(lines.last().map(String::as_str), Some("and rests"));
    }

    #[test]
    fn exponents_are_set_in_superscript() {
        assert_eq!(superscript(-12), "⁻¹²");
    }
}
