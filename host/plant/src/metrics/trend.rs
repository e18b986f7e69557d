//! How the value of a quantity can change while a run continues.

/// How the value so far can change with further samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trend {
    /// It only rises.
    Rising,
    /// It only falls.
    Falling,
    /// It only rises. While the signal is outside its band there is no value, and the next value is later than that time.
    Settling,
    /// The first value is the last one.
    Fixed,
    /// It can become any value.
    Any,
}
