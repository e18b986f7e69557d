//! Spelling of keys, values and choices in messages.

use std::fmt::Write;

/// A key as TOML would spell it, with anything unprintable escaped and anything long cut.
pub(super) fn spell_key(key: &str) -> String {
    let bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare { shorten(key) } else { spell_text(key) }
}

/// A text value in quotes, with anything unprintable escaped and anything long cut.
pub(super) fn spell_text(text: &str) -> String {
    format!("{:?}", shorten(text))
}

/// Keeps a message readable when the value found is a whole page.
fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Appends the unit, if there is one.
pub(super) fn with_unit(mut text: String, unit: &str) -> String {
    if !unit.is_empty() {
        // Writing to a String can't fail.
        let _ = write!(text, " {unit}");
    }
    text
}

/// A number as an engineer writes it: 0.5, 5000, 1e6.
pub(super) fn spell_number(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-3..1e4).contains(&size) { format!("{number:e}") } else { format!("{number}") }
}

/// `"a", "b" or "c"`.
pub(super) fn either<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let mut quoted: Vec<_> = words.into_iter().map(|word| format!("\"{word}\"")).collect();
    match quoted.pop() {
        Some(last) if quoted.is_empty() => last,
        Some(last) => format!("{} or {last}", quoted.join(", ")),
        None => String::new(),
    }
}

/// Similarity, 0 to 1, from which on a text counts as a misspelling of another.
const MIN_SIMILARITY: f64 = 0.6;

/// The word that was probably meant: one that differs by case alone, or resembles it.
pub(crate) fn nearest<'a>(text: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let small = text.to_lowercase();
    let similarity = |word: &str| strsim::normalized_damerau_levenshtein(&word.to_lowercase(), &small);
    let best = words.into_iter().map(|word| (similarity(word), word)).max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(similarity, _)| *similarity >= MIN_SIMILARITY).map(|(_, word)| word)
}

/// The number in `text` with a decimal point, if it is one with a decimal comma, such as `1,5`.
pub(super) fn decimal_point(text: &str) -> Option<String> {
    let (whole, fraction) = text.split_once(',')?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is_number =
        digits(whole.trim_start_matches(['-', '+'])) && fraction.starts_with(|c: char| c.is_ascii_digit());
    let written = format!("{whole}.{fraction}");
    (is_number && written.parse::<f64>().is_ok()).then_some(written)
}
