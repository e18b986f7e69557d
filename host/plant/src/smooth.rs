//! The paper's plant: a smooth dead zone and viscous friction, without modes.
//!
//! C = K (z - 4 j0 tanh(gamma z / 2)), equation (1), with gamma = 1 / (2 j0), equation (5), so that C has no slope at
//! z = 0. Far outside, the line is offset by 4 j0 and not by j0: the gap is four times as wide as its parameter says.

use core::convert::Infallible;

use nalgebra::Vector6;

use crate::coordinates;
use crate::error::validate_substeps;
use crate::exponential_decay::decay;
use crate::integrator::{self, HybridSystem, runge_kutta};
use crate::limits::are_in_range;
use crate::mechanics::keys;
use crate::mode::Contact;
use crate::{
    Mechanics, Numbers, ParameterError, PlantError, PlantModel, Positions, RunningPlant, SavedState, Start,
    Truth, TwoMass,
};

/// The model for scenarios.
#[must_use]
pub fn model() -> PlantModel {
    let summary = "The paper's smooth dead zone, equation (1), with viscous friction.";
    PlantModel::new("smooth", summary, keys(4), |release| {
        let plant = Smooth::new(Mechanics::of(release.values)?, release.values.integer("substeps")?)?;
        Ok(Box::new(RunningPlant::released(plant, release.start)))
    })
}

/// Parameters of the smooth plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smooth {
    mechanics: Mechanics,
    substeps: u32,
}

/// Coordinates of the smooth plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothState {
    x: Vector6<f64>,
    torque_nm: f64,
}

impl SavedState for SmoothState {
    fn save(&self, numbers: &mut Vec<f64>) {
        self.x.save(numbers);
        self.torque_nm.save(numbers);
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        Some(Self { x: SavedState::restored(numbers)?, torque_nm: SavedState::restored(numbers)? })
    }
}

impl Smooth {
    /// A smooth plant, integrated in `substeps` substeps per step; four per millisecond leave an error of 3e-12 rad at
    /// the load.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn new(mechanics: Mechanics, substeps: u32) -> Result<Self, ParameterError> {
        mechanics.validate()?;
        validate_substeps(substeps)?;
        Ok(Self { mechanics, substeps })
    }

    /// Half width of the smoothed gap 4 j0 in rad, and the shape tanh(gamma z / 2) = tanh(z / (4 j0)).
    fn shape(&self, twist_rad: f64) -> (f64, f64) {
        let half_width_rad = 4.0 * self.mechanics.dead_zone_rad;
        // tanh u = (1 - e^(-2 |u|)) / (1 + e^(-2 |u|)): half the time of a tanh that is exact near zero, where C vanishes
        // anyway.
        let decayed = decay(2.0 * libm::fabs(twist_rad) / half_width_rad);
        (half_width_rad, libm::copysign((1.0 - decayed) / (1.0 + decayed), twist_rad))
    }

    fn transmitted_torque_nm(&self, x: &Vector6<f64>) -> f64 {
        let twist_rad = self.mechanics.twist_rad(x);
        let (half_width_rad, shape) = self.shape(twist_rad);
        self.mechanics.stiffness_nm_rad * (twist_rad - half_width_rad * shape)
    }
}

impl HybridSystem for Smooth {
    type State = Vector6<f64>;
    type Mode = ();
    type Stride = f64;
    type Guard = Infallible;
    const GUARDS: &'static [Infallible] = &[];

    fn stride(&self, h_s: f64) -> f64 {
        h_s
    }

    #[inline]
    fn flow(&self, x: &Vector6<f64>, (): (), torque_nm: f64, h_s: f64) -> Vector6<f64> {
        runge_kutta(x, h_s, &|x: &Vector6<f64>, _| {
            self.mechanics.rates(x, self.transmitted_torque_nm(x), torque_nm, 0.0)
        })
    }

    fn guard(&self, guard: Infallible, _x: &Vector6<f64>, (): ()) -> f64 {
        match guard {}
    }

    fn switch(&self, guard: Infallible, _x: &mut Vector6<f64>, (): ()) {
        match guard {}
    }

    fn settle(&self, _x: &mut Vector6<f64>, (): (), _torque_nm: f64) {}

    fn is_in_range(&self, x: &Vector6<f64>) -> bool {
        are_in_range(x)
    }
}

impl TwoMass for Smooth {
    type State = SmoothState;

    fn initial_state(&self, start: Start) -> SmoothState {
        SmoothState { x: start.coordinates(), torque_nm: 0.0 }
    }

    fn step(&self, state: &mut SmoothState, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        integrator::advance(self, &mut state.x, &mut (), torque_nm, dt_s, self.substeps)?;
        state.torque_nm = torque_nm;
        Ok(())
    }

    fn positions(&self, state: &SmoothState) -> Positions {
        coordinates::positions(state.x.as_slice())
    }

    fn truth(&self, state: &SmoothState) -> Truth {
        let twist = self.mechanics.twist_rad(&state.x);
        let transmitted = self.transmitted_torque_nm(&state.x);
        let (half_width, _) = self.shape(twist);
        // ln cosh u = |u| + ln(1 + e^(-2 |u|)) - ln 2, which can't overflow.
        let u = libm::fabs(twist / half_width);
        let ln_cosh = u + libm::log1p(libm::exp(-2.0 * u)) - core::f64::consts::LN_2;
        let elastic =
            self.mechanics.stiffness_nm_rad * (0.5 * twist * twist - half_width * half_width * ln_cosh);
        let contact = Contact::outside(transmitted, 0.0);
        self.mechanics.truth(&state.x, state.torque_nm, transmitted, elastic, contact)
    }
}
