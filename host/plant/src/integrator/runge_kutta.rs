//! The classical Runge-Kutta method of fourth order.

use nalgebra::SVector;

/// Where in a step a right-hand side is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// At the beginning.
    Start,
    /// Half way; evaluated twice.
    Middle,
    /// At the end.
    End,
}

/// A right-hand side.
pub trait Rates<const N: usize> {
    /// Rates of change at `x`.
    fn at(&self, x: &SVector<f64, N>, stage: Stage) -> SVector<f64, N>;
}

impl<const N: usize, F: Fn(&SVector<f64, N>, Stage) -> SVector<f64, N>> Rates<N> for F {
    #[inline(always)]
    fn at(&self, x: &SVector<f64, N>, stage: Stage) -> SVector<f64, N> {
        self(x, stage)
    }
}

/// One step of the classical Runge-Kutta method. We inline it so that rates without influence on other rates cost nothing
/// between the stages.
#[inline(always)]
pub fn runge_kutta<const N: usize>(x: &SVector<f64, N>, h_s: f64, rates: &impl Rates<N>) -> SVector<f64, N> {
    let k1 = rates.at(x, Stage::Start);
    let k2 = rates.at(&(x + k1 * (0.5 * h_s)), Stage::Middle);
    let k3 = rates.at(&(x + k2 * (0.5 * h_s)), Stage::Middle);
    let k4 = rates.at(&(x + k3 * h_s), Stage::End);
    x + (k1 + (k2 + k3) * 2.0 + k4) * (h_s / 6.0)
}
