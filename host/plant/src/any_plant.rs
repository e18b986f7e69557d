//! The choice of a plant at run time.
//!
//! A scenario names its plant, so which one it is shows at run time only. A state that was begun with another profile is
//! an error, never a guess.

use crate::backlash_shaft::{BacklashShaft, BacklashShaftState, Environment};
use crate::hard_coulomb::{HardCoulomb, HardCoulombState};
use crate::smooth::{Smooth, SmoothState};
use crate::{Plant, PlantError, Start, Truth};

/// Any of the plants.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a run has one plant, and a box would be in the way of every step"
)]
pub enum AnyPlant {
    /// The paper's plant.
    Smooth(Smooth),
    /// Hard gap and dry friction.
    HardCoulomb(HardCoulomb),
    /// The bench as it is built.
    BacklashShaft(BacklashShaft),
}

/// The state of any of the plants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyPlantState {
    /// State of [`Smooth`].
    Smooth(SmoothState),
    /// State of [`HardCoulomb`].
    HardCoulomb(HardCoulombState),
    /// State of [`BacklashShaft`].
    BacklashShaft(BacklashShaftState),
}

const SMOOTH: &str = "smooth";
const HARD_COULOMB: &str = "hard-coulomb";
const BACKLASH_SHAFT: &str = "backlash-shaft";

impl AnyPlant {
    /// Name of the profile as scenarios write it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Smooth(_) => SMOOTH,
            Self::HardCoulomb(_) => HARD_COULOMB,
            Self::BacklashShaft(_) => BACKLASH_SHAFT,
        }
    }

    /// The state of a plant released at rest.
    pub fn initial_state(&self, start: Start) -> AnyPlantState {
        match self {
            Self::Smooth(plant) => AnyPlantState::Smooth(plant.initial_state(start)),
            Self::HardCoulomb(plant) => AnyPlantState::HardCoulomb(plant.initial_state(start)),
            Self::BacklashShaft(plant) => AnyPlantState::BacklashShaft(plant.initial_state(start)),
        }
    }

    /// Holds `torque_nm` at the motor for `dt_s` seconds.
    ///
    /// # Errors
    /// As [`Plant::step`], and when the state belongs to another profile.
    pub fn step(&self, state: &mut AnyPlantState, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        match (self, state) {
            (Self::Smooth(plant), AnyPlantState::Smooth(state)) => plant.step(state, torque_nm, dt_s),
            (Self::HardCoulomb(plant), AnyPlantState::HardCoulomb(state)) => {
                plant.step(state, torque_nm, dt_s)
            }
            (Self::BacklashShaft(plant), AnyPlantState::BacklashShaft(state)) => {
                plant.step(state, torque_nm, dt_s)
            }
            (plant, state) => Err(plant.foreign(state)),
        }
    }

    /// Changes what is around the plant from here on.
    ///
    /// # Errors
    /// The profile has fixed surroundings, the state belongs to another one, or a value is outside its range.
    pub fn surround(&self, state: &mut AnyPlantState, surroundings: Environment) -> Result<(), PlantError> {
        match (self, state) {
            (Self::BacklashShaft(plant), AnyPlantState::BacklashShaft(state)) => {
                Ok(plant.surround(state, surroundings)?)
            }
            (Self::BacklashShaft(_), state) => Err(self.foreign(state)),
            (plant, _) => Err(PlantError::FixedSurroundings { plant: plant.name() }),
        }
    }

    /// Takes a state over from a plant of the same profile that has just changed into this one. The energy that the change
    /// sets free or binds counts as dissipated, or as the reverse of it.
    ///
    /// # Errors
    /// The state belongs to another profile.
    pub fn take_over(&self, before: &Self, state: &mut AnyPlantState) -> Result<(), PlantError> {
        match (self, before, state) {
            (
                Self::BacklashShaft(plant),
                Self::BacklashShaft(before),
                AnyPlantState::BacklashShaft(state),
            ) => {
                plant.take_over(before, state);
                Ok(())
            }
            (plant, Self::BacklashShaft(_), state) => Err(plant.foreign(state)),
            (plant, ..) => Err(PlantError::FixedSurroundings { plant: plant.name() }),
        }
    }

    /// Everything there is to know about a state.
    ///
    /// # Errors
    /// The state belongs to another profile.
    pub fn truth(&self, state: &AnyPlantState) -> Result<Truth, PlantError> {
        match (self, state) {
            (Self::Smooth(plant), AnyPlantState::Smooth(state)) => Ok(plant.truth(state)),
            (Self::HardCoulomb(plant), AnyPlantState::HardCoulomb(state)) => Ok(plant.truth(state)),
            (Self::BacklashShaft(plant), AnyPlantState::BacklashShaft(state)) => Ok(plant.truth(state)),
            (plant, state) => Err(plant.foreign(state)),
        }
    }

    fn foreign(&self, state: &AnyPlantState) -> PlantError {
        PlantError::ForeignState { state: state.name(), plant: self.name() }
    }
}

impl AnyPlantState {
    /// Name of the profile the state belongs to.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Smooth(_) => SMOOTH,
            Self::HardCoulomb(_) => HARD_COULOMB,
            Self::BacklashShaft(_) => BACKLASH_SHAFT,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mechanics;

    const START: Start = Start::at_rest(0.0, 0.1);

    #[test]
    fn state_of_another_profile_is_refused_and_named() {
        let smooth = AnyPlant::Smooth(Smooth::new(Mechanics::paper(), 4).expect("valid"));
        let hard = AnyPlant::HardCoulomb(HardCoulomb::new(Mechanics::paper(), 3.84, 4).expect("valid"));
        let error = hard.step(&mut smooth.initial_state(START), 0.0, 1e-3).expect_err("foreign");
        let want =
            "state belongs to a smooth plant, this one is hard-coulomb; start from its own initial state";
        assert_eq!(error.to_string(), want);
        assert_eq!(hard.truth(&smooth.initial_state(START)), Err(error));
    }

    #[test]
    fn parameters_out_of_range_are_refused_by_name() {
        let gapless = Mechanics { dead_zone_rad: 0.0, ..Mechanics::paper() };
        let error = Smooth::new(gapless, 4).expect_err("no gap to smooth");
        assert_eq!(error.to_string(), "plant parameter dead_zone_rad is 0, allowed is 0.000001 to 10");
        assert_eq!(
            HardCoulomb::new(Mechanics::paper(), f64::NAN, 4).expect_err("NaN").name,
            "load_coulomb_nm"
        );
        assert_eq!(Smooth::new(Mechanics::paper(), 0).expect_err("no substeps").name, "substeps");
    }
}
