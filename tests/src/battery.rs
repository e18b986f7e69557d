//! The output of `lashloop conformance` on drives that pass.

use std::collections::BTreeSet;

/// What the Lashloop drive's description excludes.
pub const LASHLOOP_SKIPS: &[&str] =
    &["no law has 13 signals", "the drive has no 14 signals", "the drive has no bench mode"];

/// What the Lashloop drive excludes with a plant at its pins.
pub const LASHLOOP_BENCH_SKIPS: &[&str] = &["no law has 13 signals", "the drive has no 14 signals"];

/// What the description of a drive excludes whose single law is `pd`.
pub const PD_ALONE_SKIPS: &[&str] = &[
    "every law has every parameter",
    "every law has every signal",
    "no law has 13 signals",
    "the drive has no 14 signals",
    "the drive has no bench mode",
];

/// What the description of a drive with a single law excludes, which is not `pd`.
pub const ONE_LAW_SKIPS: &[&str] = &[
    "every law has every parameter",
    "every law has every signal",
    "no law has 13 signals",
    "the drive has no 14 signals",
    "the drive has no law pd, so it does not offer the profile",
    "the drive has no bench mode",
];

/// Of checks that need so many messages that a slow line or a busy machine takes too long.
const TOO_SLOW: &str = "not judged: this line is too slow";

/// The number of checks, of which all passed but those skipped for `reasons`, each of which occurs.
///
/// # Panics
/// A check failed or was not judged, or others are skipped.
pub fn all_passed(stdout: &str, reasons: &[&str]) -> usize {
    let lines = |start: &str| stdout.lines().filter(|line| line.starts_with(start)).count();
    let (passed, skipped) = (lines("PASS "), lines("SKIPPED "));
    let last = format!("{passed} passed, 0 failed, 0 not judged, {skipped} skipped");
    assert_eq!(stdout.lines().last(), Some(&*last), "{stdout}");
    let skips = stdout.lines().filter(|line| line.starts_with("SKIPPED "));
    let got = skips.filter_map(|line| line.rsplit_once("; ")).map(|(_, reason)| reason);
    let got: BTreeSet<_> = got.filter(|reason| *reason != TOO_SLOW).collect();
    assert_eq!(got, reasons.iter().copied().collect(), "{stdout}");
    passed + skipped
}
