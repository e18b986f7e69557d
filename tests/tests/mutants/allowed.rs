//! Mutants that no battery may find, and those that this one does not.

use std::fmt;

use lashloop_protocol::enums::State;

use crate::mutation::{Mutant, Operator, When};

/// A set of mutants: site, part (any if empty), which of them, and why.
pub struct Set {
    site: &'static str,
    part: &'static str,
    which: fn(&Mutant) -> bool,
    reason: &'static str,
}

impl Set {
    pub fn has(&self, mutant: &Mutant) -> bool {
        let (site, part) = mutant.key;
        self.site == site && (self.part.is_empty() || self.part == part) && (self.which)(mutant)
    }
}

impl fmt::Display for Set {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} | {} | {}", self.site, self.part, self.reason)
    }
}

const fn set(
    (site, part): (&'static str, &'static str),
    which: fn(&Mutant) -> bool,
    reason: &'static str,
) -> Set {
    Set { site, part, which, reason }
}

const fn all(_: &Mutant) -> bool {
    true
}

fn always(mutant: &Mutant) -> bool {
    mutant.when == When::Always && mutant.operator != Operator::Previous
}

fn by_one(mutant: &Mutant) -> bool {
    matches!(mutant.operator, Operator::Add(_))
}

const fn in_no_run(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::In(State::Boot | State::Idle | State::Armed | State::Faulted))
}

const fn either_way(mutant: &Mutant) -> bool {
    matches!(mutant.operator, Operator::Negated | Operator::Absolute)
}

const fn in_boot(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::In(State::Boot))
}

const fn in_boot_or_faulted(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::In(State::Boot | State::Faulted))
}

fn always_by_one(mutant: &Mutant) -> bool {
    by_one(mutant) && mutant.when == When::Always
}

fn earlier(mutant: &Mutant) -> bool {
    mutant.operator == Operator::Add(-1.0)
}

/// Slightly wrong, as a clock may be.
fn slightly(mutant: &Mutant) -> bool {
    by_one(mutant) || mutant.operator == Operator::Scale(2.0)
}

/// Wrong from the first step on, at the first or from the second on. Velocities are zero in the first.
const fn from_first_or_second(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::Always | When::Once | When::Later)
}

fn is_previous(mutant: &Mutant) -> bool {
    mutant.operator == Operator::Previous
}

const FIRST_USE: &str = "the value before, in the first of several uses after a change";
const FREE_NUMBER: &str = "the number of a build is the drive's own";
const FREE_TEXT: &str = "other names, units and texts are allowed";
const OWN_LAW: &str = "what a law makes of its parameters is the drive's own";
const UNUSED: &str = "the field is not used in this state";
const REFUSED_FIRST: &str = "the state is checked before";
const CLOCK_US: &str = "a microsecond, where no other message has the same device time";
const CLOCK: &str = "the difference is below a millisecond of the drive's clock";

/// Mutants that keep every rule of the page.
pub const EQUIVALENT: &[Set] = &[
    set(("Identity", "build_id"), |it| it.when == When::Always, FREE_NUMBER),
    set(
        ("Identity", "dirty"),
        |it| it.when == When::Always && it.operator == Operator::Add(1.0),
        "1 is allowed, and any other byte reads as 1",
    ),
    set(("Identity", "board"), |it| always(it) && it.operator != Operator::Unterminated, FREE_TEXT),
    set(("Hello", "minor_version"), all, "the minor version of a host changes nothing"),
    set(("Identity", "minor_version"), always_by_one, "the minor version of a drive is its own"),
    set(("Identity", "device_time_us"), earlier, CLOCK_US),
    set(("LineReport", "device_time_us"), earlier, CLOCK_US),
    set(("ParameterReport", "device_time_us"), by_one, CLOCK_US),
    set(("CommandResult", "device_time_us"), |it| it.operator == Operator::Add(1.0), CLOCK_US),
    set(
        ("SetParameter", "refused for another value"),
        |it| matches!(it.operator, Operator::To(0) | Operator::Previous),
        "which values contradict each other is the drive's own",
    ),
    set(
        ("ParameterDescription", "unit"),
        |it| always(it) && it.operator != Operator::Unterminated,
        FREE_TEXT,
    ),
    set(("SignalDescription", "unit"), |it| always(it) && it.operator != Operator::Unterminated, FREE_TEXT),
    set(
        ("SignalDescription", "name"),
        |it| matches!((it.operator, it.when), (Operator::Shortened | Operator::Altered, When::Always)),
        FREE_TEXT,
    ),
    set(
        ("frame", "delimiters"),
        |it| it.operator == Operator::Next,
        "a drive may send delimiters between frames",
    ),
    set(
        ("TorqueAnswer", "compute_tenths_us"),
        |it| {
            matches!(it.operator, Operator::Zero | Operator::Scale(1e-3))
                || slightly(it) && !matches!(it.when, When::Once | When::Later | When::After(8))
        },
        "a measurement of the drive's own clock, which may be coarse",
    ),
    // Another law than the one in force, from the first or second run on, shows by its lack of a live parameter.
    set(
        ("effect of a parameter", "controller"),
        |it| from_first_or_second(it) && (it.when == When::Once || it.operator != Operator::Add(1.0)),
        OWN_LAW,
    ),
    set(("effect of a parameter", "gain_nm_rad"), |it| always(it) && it.operator != Operator::Zero, OWN_LAW),
    set(("effect of a parameter", "damping_nm_s_rad"), from_first_or_second, OWN_LAW),
    set(("effect of a parameter", "integral_gain_1_s"), from_first_or_second, OWN_LAW),
    set(("effect of a parameter", "output"), |it| it.when == When::Always, OWN_LAW),
    set(
        ("position of the first sample", ""),
        |it| by_one(it) && it.when == When::Always,
        "one count of an unknown law",
    ),
    set(("EncoderSample", "motor_counts"), in_no_run, UNUSED),
    set(("EncoderSample", "load_counts"), in_no_run, UNUSED),
    set(("EncoderSample", "reference_rad"), in_no_run, UNUSED),
    set(("EncoderSample", "sequence"), in_boot, UNUSED),
    set(
        ("EncoderSample", "reference_rad"),
        |it| {
            matches!(it.operator, Operator::Add(1.0) | Operator::Scale(1e-3))
                && matches!(it.when, When::Always | When::In(State::Running))
        },
        OWN_LAW,
    ),
    set(("Arm", "session"), in_boot, "no session is open"),
    set(("Start", "session"), in_boot, "no session is open"),
    set(("SetParameter", "value"), in_boot_or_faulted, REFUSED_FIRST),
    set(("SetParameter", "is NaN"), in_boot_or_faulted, REFUSED_FIRST),
    set(("SetParameter", "is above its range"), in_boot_or_faulted, REFUSED_FIRST),
    set(("SetParameter", "is below its range"), in_boot_or_faulted, REFUSED_FIRST),
    set(("Subscribe", "signals"), in_boot_or_faulted, REFUSED_FIRST),
    set(("Subscribe", "every"), in_boot_or_faulted, REFUSED_FIRST),
    set(("Subscribe", "most signals"), in_boot_or_faulted, REFUSED_FIRST),
    set(("watchdog", "limit"), by_one, CLOCK),
    set(("effect of a parameter", "watchdog_us"), |it| it.operator == Operator::Previous, CLOCK),
    set(("watchdog", "limit"), |it| it.operator == Operator::Previous, CLOCK),
    set(("feeds the watchdog", "a millisecond"), |it| it.when == When::Once, CLOCK),
    set(("ClearFault", "is done though refused"), in_boot, "without a session it leads to Boot"),
    set(
        ("SetParameter", "value"),
        |it| it.when == When::Negative && it.operator == Operator::Scale(2.0),
        "no negative value is in any range",
    ),
    set(("watchdog", "trips at its limit"), all, CLOCK),
    set(("load jump", "counts"), either_way, "the speed has no sign"),
    set(("motor jump", "counts"), either_way, "the speed has no sign"),
    set(("watchdog", "time between two looks"), |it| it.operator != Operator::Scale(1e3), CLOCK),
    set(("watchdog", "is looked at when a sample arrives"), all, CLOCK),
];

/// Wrong after eight times since the power-up.
const fn late(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::After(_))
}

const fn not_at_first(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::After(_) | When::Later)
}

const fn at_first(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::Once)
}

/// In the test of `Arm`, which comes first.
const fn at_arm(mutant: &Mutant) -> bool {
    matches!(mutant.when, When::Once | When::In(State::Idle))
}

const fn scaled(mutant: &Mutant) -> bool {
    matches!(mutant.operator, Operator::Scale(_))
}

const LATE: &str = "it shows after eight repetitions in one check, which cost time on a slow line";
const AT_FIRST: &str = "it shows at the first time after a reset alone";
const FIRST_BEYOND: &str = "the torques compared are those of the first sample beyond the bound";
const BY_ONE: &str = "the bound is tested to more than one count or microsecond";

/// Mutants that break a rule and are not found.
pub const NOT_FOUND: &[Set] = &[
    set(("stray sample", "keeps the stored answer"), late, LATE),
    set(("position beyond 2^25", ""), not_at_first, FIRST_BEYOND),
    set(("position beyond 2^26", ""), not_at_first, FIRST_BEYOND),
    set(("position in single precision", ""), at_first, AT_FIRST),
    set(
        ("ParameterReport", "detail"),
        |it| matches!(it.operator, Operator::Zero | Operator::Scale(_)),
        "which parameter does not go with the others is the drive's own",
    ),
    set(("torque after a gap", "is that of its own step"), late, LATE),
    set(("watchdog", "runs on in Armed after a run"), at_first, AT_FIRST),
    set(
        ("watchdog", "silence"),
        |it| it.operator == Operator::Other,
        "a drive that looks often trips at a silence that rounds to the limit",
    ),
    set(
        ("effect of a parameter", "motor_counts_per_rev"),
        by_one,
        "1.5e-5 of it, near the tolerance of a speed",
    ),
    set(("effect of a parameter", "load_counts_per_rev"), at_arm, BY_ONE),
    set(("effect of a parameter", "load_counts_per_rev"), is_previous, FIRST_USE),
    set(("effect of a parameter", "motor_counts_per_rev"), is_previous, FIRST_USE),
    set(("effect of a parameter", "period_us"), is_previous, FIRST_USE),
    set(("effect of a parameter", "period_us"), at_arm, BY_ONE),
    set(("effect of a parameter", "load_speed_limit_rad_s"), |it| at_arm(it) || late(it), BY_ONE),
    set(("effect of a parameter", "motor_speed_limit_rad_s"), |it| at_arm(it) || late(it), BY_ONE),
    set(("effect of a parameter", "watchdog_us"), by_one, BY_ONE),
    set(("longest gap", "motor"), late, BY_ONE),
    set(("longest gap", "load"), late, BY_ONE),
    set(("motor jump", "counts forgiven"), |it| late(it) || at_first(it), BY_ONE),
    set(("load jump", "counts forgiven"), |it| late(it) || at_first(it), BY_ONE),
    set(("motor jump", "backwards too"), late, LATE),
    set(("load jump", "backwards too"), late, LATE),
    set(("load jump", "the first sample has no speed"), late, LATE),
    set(("motor jump", "the first sample has no speed"), late, LATE),
    set(("Start resets", "the watchdog"), late, LATE),
    set(("Start resets", "the encoders"), late, LATE),
    set(("ClearFault", "forgets the fault"), late, LATE),
    set(("sequence", "is modulo 2^16"), late, LATE),
    set(("receiver", "a pause ends a frame"), at_first, AT_FIRST),
    set(("receiver", "longest frame"), at_first, AT_FIRST),
    set(("feeds the watchdog", "GetParameter"), at_first, AT_FIRST),
    set(
        ("feeds the watchdog", "ClearFault"),
        not_at_first,
        "only the first is sent before the watchdog trips",
    ),
    set(
        ("position of the first sample", ""),
        scaled,
        "so far from its reference the torque of an unknown law is at its limit",
    ),
];
