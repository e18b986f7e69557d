//! Most code lines of each package.

/// By the package's folder. A limit may only fall; code of a new package leaves another one.
pub(super) const LIMITS: &[(&str, usize)] = &[
    ("benchmarks/codec", 900),
    ("benchmarks/plant", 300),
    ("examples/own-law", 150),
    ("examples/own-plant", 200),
    ("examples/published-laws", 1_500),
    ("firmware", 5_550),
    ("host", 19_050),
    ("host/bench", 11_600),
    ("host/campaign", 4_100),
    ("host/identify", 2_150),
    ("host/link", 1_550),
    ("host/plant", 3_750),
    ("host/record", 3_700),
    ("host/report", 5_500),
    ("host/session", 2_150),
    ("protocol", 1_700),
    ("virtual-silicon", 1_450),
    ("xtask", 2_100),
];
