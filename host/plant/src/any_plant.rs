//! The choice of a plant at run time: a scenario names its plant.

use crate::backlash_shaft::{BacklashShaft, Environment};
use crate::hard_coulomb::HardCoulomb;
use crate::smooth::Smooth;
use crate::{PlantError, RunningPlant, Truth};

/// Model of the gap between motor and load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlantModel {
    /// The paper's smooth dead zone, equation (1), with viscous friction.
    Smooth,
    /// A gap with hard edges, with viscous and Coulomb friction on the load.
    HardCoulomb,
    /// Physical backlash with a damped shaft, Stribeck friction on both sides, and a drive that lags and saturates.
    BacklashShaft,
}

impl PlantModel {
    /// All models.
    pub const ALL: [Self; 3] = [Self::Smooth, Self::HardCoulomb, Self::BacklashShaft];

    /// Name of the model, as scenarios write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::HardCoulomb => "hard-coulomb",
            Self::BacklashShaft => "backlash-shaft",
        }
    }
}

/// Any of the plants, with its state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a run has one plant, and a box would cost an indirection in every step"
)]
pub enum AnyPlant {
    /// The paper's plant.
    Smooth(RunningPlant<Smooth>),
    /// Hard gap and Coulomb friction.
    HardCoulomb(RunningPlant<HardCoulomb>),
    /// Physical backlash in series with a damped shaft.
    BacklashShaft(RunningPlant<BacklashShaft>),
}

impl AnyPlant {
    /// Holds `torque_nm` at the motor for `dt_s` seconds.
    ///
    /// # Errors
    /// As [`Plant::step`](crate::Plant::step).
    pub fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        match self {
            Self::Smooth(plant) => plant.step(torque_nm, dt_s),
            Self::HardCoulomb(plant) => plant.step(torque_nm, dt_s),
            Self::BacklashShaft(plant) => plant.step(torque_nm, dt_s),
        }
    }

    /// Everything that can be known about the present state.
    pub fn truth(&self) -> Truth {
        match self {
            Self::Smooth(plant) => plant.truth(),
            Self::HardCoulomb(plant) => plant.truth(),
            Self::BacklashShaft(plant) => plant.truth(),
        }
    }

    /// Changes gap and load torque from now on.
    ///
    /// # Errors
    /// The plant's environment is fixed, or a value is outside its range.
    pub fn set_environment(&mut self, environment: Environment) -> Result<(), PlantError> {
        Ok(self.changeable()?.set_environment(environment)?)
    }

    /// Replaces the parameters from now on and keeps the state.
    ///
    /// # Errors
    /// The plant's parameters are fixed.
    pub fn change_parameters(&mut self, parameters: BacklashShaft) -> Result<(), PlantError> {
        self.changeable()?.change_parameters(parameters);
        Ok(())
    }

    /// The one plant that changes while it runs.
    fn changeable(&mut self) -> Result<&mut RunningPlant<BacklashShaft>, PlantError> {
        match self {
            Self::BacklashShaft(plant) => Ok(plant),
            Self::Smooth(_) => Err(PlantError::FixedEnvironment { plant: PlantModel::Smooth.name() }),
            Self::HardCoulomb(_) => {
                Err(PlantError::FixedEnvironment { plant: PlantModel::HardCoulomb.name() })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mechanics, Start};

    #[test]
    fn fixed_environment_is_an_error_that_names_the_plant() {
        let smooth = Smooth::new(Mechanics::paper(), 4).expect("valid");
        let mut plant = AnyPlant::Smooth(RunningPlant::released(smooth, Start::at_rest(0.0, 0.1)));
        let before = plant;
        let error = plant
            .set_environment(Environment { dead_zone_rad: 0.2, load_torque_nm: 0.0 })
            .expect_err("a smooth gap does not wear");
        let want = "a smooth plant takes no load torque, wear or change of parameters; \
                    use the backlash-shaft plant for them";
        assert_eq!(error.to_string(), want);
        assert_eq!(plant, before);
    }

    #[test]
    fn parameters_out_of_range_are_rejected_by_name() {
        let gapless = Mechanics { dead_zone_rad: 0.0, ..Mechanics::paper() };
        let error = Smooth::new(gapless, 4).expect_err("no gap to smooth");
        let want = "parameter dead_zone_rad of the simulated plant is 0, allowed is 0.000001 to 10";
        assert_eq!(error.to_string(), want);
        let not_a_number = HardCoulomb::new(Mechanics::paper(), f64::NAN, 4).expect_err("NaN");
        assert_eq!(not_a_number.name, "load_coulomb_nm");
        assert_eq!(Smooth::new(Mechanics::paper(), 0).expect_err("no substeps").name, "substeps");
    }
}
