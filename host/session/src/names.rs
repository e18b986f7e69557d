//! Names in messages: lists of them, and the one that was probably meant.

/// Similarity, 0 to 1, from which on a name counts as a misspelling of another.
const MIN_SIMILARITY: f64 = 0.75;

/// Fewest letters of a part of a name that may stand for it.
const SHORTEST_PART: usize = 3;

/// A name that nothing has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{owner} has no {kind} of this name{}; it has {known}", suggestion(nearest.as_deref()))]
pub struct UnknownName {
    /// What should have it, such as `the drive`.
    pub owner: &'static str,
    /// What was looked for, such as `law`.
    pub kind: &'static str,
    /// The name, for a message that has not named it yet.
    pub name: Box<str>,
    /// The name that was probably meant, if one resembles it.
    pub nearest: Option<String>,
    /// All names, separated by commas.
    pub known: String,
}

impl UnknownName {
    /// The error for `name`, which is none of `known`.
    pub fn new<'a>(
        owner: &'static str,
        kind: &'static str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let known: Vec<_> = known.into_iter().collect();
        // A name without its prefix or unit is more than similar.
        let small = name.to_lowercase();
        let similarity = |other: &&str| {
            let other = other.to_lowercase();
            // The shorter of two names of which it is a part, and one that begins with it first.
            let is_part = small.len() >= SHORTEST_PART && other.contains(&small);
            match (is_part, other.starts_with(&small)) {
                (true, begins) => 1.0 + f64::from(begins) + 1.0 / (1.0 + other.len() as f64),
                (false, _) => strsim::jaro_winkler(&other, &small),
            }
        };
        let nearest = known.iter().map(|known| (similarity(known), *known));
        let nearest = nearest.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(it, _)| *it >= MIN_SIMILARITY);
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        Self { owner, kind, name: name.into(), nearest: nearest.map(|(_, name)| name.to_owned()), known }
    }
}

/// `a, b or c`; empty without a word.
pub(crate) fn in_words<'a>(words: impl IntoIterator<Item = &'a str>, last_joint: &str) -> String {
    let mut words: Vec<_> = words.into_iter().collect();
    match (words.pop(), words.is_empty()) {
        (None, _) => String::new(),
        (Some(only), true) => only.to_owned(),
        (Some(last), false) => format!("{} {last_joint} {last}", words.join(", ")),
    }
}

fn suggestion(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(" (did you mean {name}?)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelling_gets_the_nearest_name_and_all_others() {
        let error = |name| UnknownName::new("the drive", "law", name, ["pd", "merzouki"]).to_string();
        assert_eq!(
            error("merzuki"),
            "the drive has no law of this name (did you mean merzouki?); it has pd, merzouki"
        );
        let column = UnknownName::new("the record", "signal", "speed", ["torque_nm", "drive.speed_rad_s"]);
        assert_eq!(column.nearest.as_deref(), Some("drive.speed_rad_s"));
        assert!(error("PD").contains("did you mean pd?"), "case makes a difference of spelling only");
        assert_eq!(error("lqr"), "the drive has no law of this name; it has pd, merzouki");
        let nothing = UnknownName::new("the drive", "signal", "x", []).to_string();
        assert_eq!(nothing, "the drive has no signal of this name; it has none");
    }
}
