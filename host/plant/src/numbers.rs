//! Numbers of parameters, declared once: place, key, unit, range and meaning.

/// Declares numbers of a type, a row each: place, name in errors, name of the key if it differs, unit, allowed range, range of
/// the key if it differs, and meaning. Defaults are those of the
/// given function of the type; an allowed range may use the other numbers by the given name.
macro_rules! numbers {
    ($type:ident, $default:ident, $it:ident: $($($place:ident).+: $name:literal $(as $key:literal)?, $unit:literal, $range:expr $(, given $given:expr)?, $meaning:literal;)+) => {
        impl $type {
            /// The keys of the numbers.
            pub(crate) fn keys() -> [$crate::Key; [$($name),+].len()] {
                let $it = Self::$default();
                [$({
                    let (name, range) = (numbers!(@last $name $(, $key)?), numbers!(@last $range $(, $given)?));
                    $crate::Key::number(name, $unit, $it.$($place).+, range, $meaning)
                }),+]
            }

            /// The numbers of these values, the rest by default.
            pub(crate) fn of(values: &$crate::PlantValues) -> Result<Self, $crate::PlantError> {
                let mut $it = Self::$default();
                $($it.$($place).+ = values.number(numbers!(@last $name $(, $key)?))?;)+
                Ok($it)
            }

            /// Names the first number outside its range.
            fn check(&self) -> Result<(), $crate::ParameterError> {
                let $it = self;
                $($crate::error::in_range($name, $it.$($place).+, &($range))?;)+
                Ok(())
            }
        }
    };
    (@last $first:expr) => { $first };
    (@last $first:expr, $last:expr) => { $last };
}
pub(crate) use numbers;
