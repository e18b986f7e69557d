//! The trait of a system that switches between smooth modes.
//!
//! A system brings its own step, [`HybridSystem::flow`]: what has a closed form (a lag, a spring that relaxes) takes it,
//! and Runge-Kutta integrates the rest.

/// A system that switches between smooth modes.
pub trait HybridSystem {
    /// Everything that moves.
    type State: Copy;

    /// The mode, which selects the right-hand side.
    type Mode: Copy;

    /// A step length and the quantities that depend on nothing else, computed once.
    type Stride: Copy;

    /// A guard function, whose change of sign ends a mode.
    type Guard: Copy + 'static;

    /// Every guard function; of simultaneous events the first in this list counts.
    const GUARDS: &'static [Self::Guard];

    /// A stride of `h_s` seconds.
    fn stride(&self, h_s: f64) -> Self::Stride;

    /// The state one stride later if `mode` holds that long; also valid a little beyond the end of the mode.
    fn flow(&self, x: &Self::State, mode: Self::Mode, torque_nm: f64, stride: Self::Stride) -> Self::State;

    /// Value of a guard function: not negative while `mode` holds, and smooth across its end.
    fn guard(&self, guard: Self::Guard, x: &Self::State, mode: Self::Mode) -> f64;

    /// The mode that follows where `guard` has reached zero; sets the coordinates that are known exactly
    /// there.
    fn switch(&self, guard: Self::Guard, x: &mut Self::State, mode: Self::Mode) -> Self::Mode;

    /// The mode under a torque that has just changed; sets the coordinates that follow the torque without lag.
    fn settle(&self, x: &mut Self::State, mode: Self::Mode, torque_nm: f64) -> Self::Mode;

    /// Whether every coordinate is within [`MAX_COORDINATE`](crate::limits::MAX_COORDINATE).
    fn is_in_range(&self, x: &Self::State) -> bool;
}
