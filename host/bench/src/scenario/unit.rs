//! Units of keys, and the recognition of a right quantity in a wrong unit.
//!
//! A key is a quantity with its unit, such as `stiffness_nm_rad`. Keys that differ in their trailing unit words only name the
//! same quantity. `stiffness_nm_deg` is therefore reported as a wrong unit and not as a misspelling: its value is wrong by a
//! factor of 57.

/// The units by the ends of keys, longer ends first.
#[rustfmt::skip]
const UNITS: &[(&str, &str)] = &[
    ("kg_m2", "kg m^2"), ("nm_s_rad", "N m s/rad"), ("nm_rad", "N m/rad"), ("nm_s", "N m/s"), ("nm_a", "N m/A"),
    ("nm", "N m"), ("ohm", "Ohm"), ("h", "H"), ("a", "A"), ("v", "V"), ("ns", "ns"),
    ("rad_s2", "rad/s^2"), ("rad_s", "rad/s"), ("rad", "rad"),
    ("ms", "ms"), ("us", "us"), ("s", "s"), ("hz", "Hz"),
    ("counts_per_rev", "counts/rev"), ("counts", "counts"), ("baud", "Bd"), ("steps", "steps"), ("rows", "rows"),
    ("lost", "steps"), ("late", "steps"), ("late_in_a_row", "steps"),
];

/// The unit of a key or a signal, by the end of its name; empty for a pure number.
#[must_use]
pub fn of(key: &str) -> &'static str {
    let ends_with =
        |end: &str| key.strip_suffix(end).is_some_and(|before| before.is_empty() || before.ends_with('_'));
    UNITS.iter().find(|(end, _)| ends_with(end)).map_or("", |(_, unit)| unit)
}

/// Words that occur in keys as parts of units only.
#[rustfmt::skip]
const WORDS: &[&str] = &[
    "s", "s2", "sec", "seconds", "ms", "us", "ns", "min", "minutes", "h", "hz", "khz", "mhz",
    "rad", "mrad", "deg", "degrees", "rev", "turns", "rpm", "counts", "count", "per", "ticks", "lsb",
    "n", "kn", "mn", "m", "mm", "cm", "nm", "knm", "mnm", "nms", "kg", "g", "m2", "cm2", "mm2", "kgm2", "gcm2",
    "ohm", "a", "v", "steps", "rows",
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
