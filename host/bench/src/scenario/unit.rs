//! Units as the reader names them, and the recognition of a right quantity in a wrong unit.
//!
//! A key is a quantity with its unit, such as `stiffness_nm_rad`. Keys that differ in their trailing unit words only name the
//! same quantity. `stiffness_nm_deg` is therefore reported as a wrong unit and not as a misspelling: its value is wrong by a
//! factor of 57.

/// No unit: a count of something that its key names, or a pure number.
pub(super) const NONE: &str = "";
pub(super) const SECOND: &str = "s";
pub(super) const MILLISECOND: &str = "ms";
pub(super) const MICROSECOND: &str = "us";
pub(super) const HERTZ: &str = "Hz";
pub(super) const RADIAN: &str = "rad";
pub(super) const RADIAN_PER_SECOND: &str = "rad/s";
pub(super) const RADIAN_PER_SECOND_SQUARED: &str = "rad/s^2";
pub(super) const NEWTON_METRE: &str = "N m";
pub(super) const NEWTON_METRE_PER_RADIAN: &str = "N m/rad";
pub(super) const NEWTON_METRE_SECOND: &str = "N m s/rad";
pub(super) const KILOGRAM_SQUARE_METRE: &str = "kg m^2";
pub(super) const COUNT: &str = "counts";
pub(super) const COUNT_PER_REVOLUTION: &str = "counts/rev";
pub(super) const BAUD: &str = "Bd";
pub(super) const STEP: &str = "steps";
pub(super) const ROW: &str = "rows";

/// Words that occur in keys as parts of units only.
#[rustfmt::skip]
const WORDS: &[&str] = &[
    "s", "s2", "sec", "seconds", "ms", "us", "ns", "min", "minutes", "h", "hz", "khz", "mhz",
    "rad", "mrad", "deg", "degrees", "rev", "turns", "rpm", "counts", "count", "per", "ticks", "lsb",
    "n", "kn", "mn", "m", "mm", "cm", "nm", "knm", "mnm", "nms", "kg", "g", "m2", "cm2", "mm2", "kgm2", "gcm2",
    "steps", "rows",
];

/// Whether two keys name one quantity, in any units.
pub(super) fn same_quantity(one: &str, other: &str) -> bool {
    quantity(one) == quantity(other)
}

/// The key without its trailing unit words.
fn quantity(key: &str) -> &str {
    let mut rest = key;
    while let Some((before, word)) = rest.rsplit_once('_') {
        if !WORDS.contains(&word) {
            break;
        }
        rest = before;
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::same_quantity;

    #[test]
    fn a_quantity_is_recognised_in_any_unit_or_none() {
        assert!(same_quantity("duration_ms", "duration_s"));
        assert!(same_quantity("stiffness_nm_deg", "stiffness_nm_rad"));
        assert!(same_quantity("load_inertia", "load_inertia_kg_m2"));
        assert!(same_quantity("motor_rev", "motor_counts_per_rev"));
    }

    #[test]
    fn quantities_with_a_common_unit_differ() {
        assert!(!same_quantity("load_velocity_rad_s", "motor_velocity_rad_s"));
        assert!(!same_quantity("load_friction_nm_s_rad", "load_inertia_kg_m2"));
        assert!(!same_quantity("s", "m"));
    }
}
