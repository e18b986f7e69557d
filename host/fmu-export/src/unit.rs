//! Units in the terms of FMI: a name, and exponents of the base units.

/// The base units of FMI that we use, in the order of [`SiUnit::exponents`].
pub(crate) const BASES: [&str; 5] = ["kg", "m", "s", "A", "rad"];

/// A unit as a product of powers of the base units, with a factor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SiUnit {
    pub(crate) exponents: [i8; BASES.len()],
    pub(crate) factor: f64,
}

/// Symbols, their exponents and factors.
#[rustfmt::skip]
const SYMBOLS: [(&str, [i8; BASES.len()], f64); 16] = [
    ("kg", [1, 0, 0, 0, 0], 1.0), ("m", [0, 1, 0, 0, 0], 1.0), ("s", [0, 0, 1, 0, 0], 1.0), ("A", [0, 0, 0, 1, 0], 1.0),
    ("rad", [0, 0, 0, 0, 1], 1.0), ("N", [1, 1, -2, 0, 0], 1.0), ("J", [1, 2, -2, 0, 0], 1.0), ("W", [1, 2, -3, 0, 0], 1.0),
    ("V", [1, 2, -3, -1, 0], 1.0), ("Ohm", [1, 2, -3, -2, 0], 1.0), ("H", [1, 2, -2, -2, 0], 1.0), ("Hz", [0, 0, -1, 0, 0], 1.0),
    ("ms", [0, 0, 1, 0, 0], 1e-3), ("us", [0, 0, 1, 0, 0], 1e-6), ("ns", [0, 0, 1, 0, 0], 1e-9), ("1", [0; 5], 1.0),
];

/// The name of a unit in FMI: `N.m/rad` for `N m/rad`.
pub(crate) fn name(unit: &str) -> String {
    unit.replace(' ', ".").replace('^', "")
}

/// A unit in base units; `None` for one without, such as counts. What follows a `/` divides.
pub(crate) fn of(unit: &str) -> Option<SiUnit> {
    let mut si = SiUnit { exponents: [0; BASES.len()], factor: 1.0 };
    for (part, sign) in unit.split('/').zip([1, -1]) {
        for word in part.split(' ') {
            let (symbol, power) = word.split_once('^').unwrap_or((word, "1"));
            let power = sign * power.parse::<i8>().ok()?;
            let (_, exponents, factor) = SYMBOLS.iter().find(|(name, ..)| *name == symbol)?;
            for (sum, exponent) in si.exponents.iter_mut().zip(exponents) {
                *sum += power * exponent;
            }
            si.factor *= factor.powi(power.into());
        }
    }
    Some(si)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_products_of_base_units() {
        let exponents = |unit: &str| of(unit).map(|si| si.exponents);
        assert_eq!(exponents("N m"), Some([1, 2, -2, 0, 0]));
        assert_eq!(exponents("N m s/rad"), Some([1, 2, -1, 0, -1]));
        assert_eq!(exponents("rad/s^2"), Some([0, 0, -2, 0, 1]));
        assert_eq!(exponents("N m/A"), Some([1, 2, -2, -1, 0]));
        assert_eq!(of("us").map(|si| si.factor), Some(1e-6));
        assert_eq!(of("counts/rev"), None);
        assert_eq!(name("kg m^2"), "kg.m2");
        assert_eq!(name("rad/s^2"), "rad/s2");
    }
}
