//! Texts of a table while the drive is compiled: lengths, repetitions, and the message of a declaration that doesn't compile.

/// Checks names of one kind, such as `a law`: each as [`check_name`] does, and that no two are equal.
pub(super) const fn check_names(kind: &str, names: &[&str], longest: usize, too_long: &str, repeated: &str) {
    let mut at = 0;
    while at < names.len() {
        check_name(kind, names[at], longest, too_long);
        let mut earlier = 0;
        while earlier < at {
            if same_text(names[earlier], names[at]) {
                fail(names[at], repeated);
            }
            earlier += 1;
        }
        at += 1;
    }
}

/// Names are not empty; units may be.
pub(super) const fn check_name(kind: &str, name: &str, longest: usize, too_long: &str) {
    if name.is_empty() {
        fail(kind, "has an empty name");
    }
    check_text(name, longest, too_long);
}

pub(super) const fn check_text(text: &str, longest: usize, problem: &str) {
    if text.len() > longest {
        fail(text, problem);
    }
}

pub(super) const fn same_text(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut at = 0;
    while at < a.len() && at < b.len() && a[at] == b[at] {
        at += 1;
    }
    at == a.len() && at == b.len()
}

pub(super) const fn same_texts(a: &[&str], b: &[&str]) -> bool {
    let mut at = 0;
    while at < a.len() && at < b.len() && same_text(a[at], b[at]) {
        at += 1;
    }
    at == a.len() && at == b.len()
}

/// Ends the compilation with "`name` `problem`". A constant can't format two texts, so they are joined byte by byte.
pub(super) const fn fail(name: &str, problem: &str) -> ! {
    let mut text = [b' '; 160];
    let name = name.as_bytes();
    let mut at = 0;
    while at < name.len() && at < 60 {
        text[at] = name[at];
        at += 1;
    }
    let mut from = 0;
    at += 1;
    while from < problem.len() && at < text.len() {
        text[at] = problem.as_bytes()[from];
        (at, from) = (at + 1, from + 1);
    }
    match core::str::from_utf8(text.split_at(at).0) {
        Ok(text) => panic!("{}", text),
        Err(_) => panic!("a declaration is invalid"),
    }
}
