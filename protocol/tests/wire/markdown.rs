//! Tables and fences of `docs/protocol.md` and its annexes.

/// A document of the specification, by its path below `docs`.
macro_rules! document {
    ($path:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/", $path))
    };
}

/// The page and its annexes, in the order of their sections.
pub const PROTOCOL: &str = concat!(
    document!("protocol.md"),
    document!("protocol/bytes.md"),
    document!("protocol/lashloop-drive.md"),
    document!("protocol/profile-pd.md"),
    document!("protocol/bench-mode.md"),
    document!("protocol/options.md"),
);

/// The text between this heading and the next one of any level.
pub fn section(heading: &str) -> &'static str {
    let (_, after) = (PROTOCOL.split_once(&format!("\n{heading}\n")))
        .unwrap_or_else(|| panic!("neither docs/protocol.md nor an annex has the heading {heading:?}"));
    after.split("\n#").next().unwrap_or(after)
}

/// The text from this heading of level 2 to the next one, parts of lower levels included.
pub fn whole_section(heading: &str) -> &'static str {
    let (_, after) = (PROTOCOL.split_once(&format!("\n{heading}")))
        .unwrap_or_else(|| panic!("neither docs/protocol.md nor an annex has the heading {heading:?}"));
    after.split("\n## ").next().unwrap_or(after)
}

/// The rows of the table in `section` whose first column has this header, without markup.
pub fn table(section: &str, first_header: &str) -> Vec<Vec<String>> {
    let mut lines =
        section.lines().skip_while(|line| cells(line).first().is_none_or(|it| it != first_header));
    assert!(lines.next().is_some(), "no table with {first_header:?} first in: {section}");
    let rows: Vec<_> = lines.skip(1).take_while(|line| line.starts_with('|')).map(cells).collect();
    assert!(!rows.is_empty(), "the table with {first_header:?} first is empty");
    rows
}

fn cells(line: &str) -> Vec<String> {
    let Some(inner) = line.strip_prefix('|').and_then(|line| line.strip_suffix('|')) else {
        return Vec::new();
    };
    inner.split('|').map(|cell| cell.trim().replace('`', "")).collect()
}

/// The fenced blocks of `section`.
pub fn fences(section: &'static str) -> Vec<&'static str> {
    section
        .split("```")
        .skip(1)
        .step_by(2)
        .map(|fence| fence.strip_prefix("text\n").unwrap_or(fence).trim_end())
        .collect()
}

/// The data sheets of the conversation, in order.
pub fn sheets() -> Vec<&'static str> {
    let fences = fences(whole_section("## 15. A conversation, byte by byte"));
    fences.into_iter().filter(|fence| fence.contains("\nframe: ")).collect()
}
