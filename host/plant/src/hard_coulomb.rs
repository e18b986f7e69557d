//! A hard gap and Coulomb friction on the load: the simplest plant with the static error of the paper's experiment.
//!
//! C = K (z - j0) in positive contact, K (z + j0) in negative contact, zero in the gap; the contact never pulls. The load
//! carries Coulomb friction F_c and viscous friction, and sticks while |N0 C| <= F_c. With F_c = 3.84 N m the
//! proportional-derivative cascade stops at (3 F_c / N0 + 2 j0) / 13 = 0.3200 rad, the paper's static error.

use std::ops::RangeInclusive;

use nalgebra::Vector6;

use crate::coordinates::{self, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION};
use crate::error::{in_range, validate_substeps};
use crate::integrator::{self, HybridSystem, runge_kutta};
use crate::limits::are_in_range;
use crate::mechanics::keys;
use crate::mode::{Contact, DryFriction, Flank};
use crate::{
    Key, Mechanics, Numbers, ParameterError, PlantError, PlantModel, Positions, RunningPlant, SavedState,
    Start, Truth, TwoMass,
};

/// Allowed Coulomb friction.
const LOAD_COULOMB_NM: RangeInclusive<f64> = 0.0..=1e6;

/// The model for scenarios.
#[must_use]
pub fn model() -> PlantModel {
    let mut keys = keys(4);
    let meaning = "Coulomb friction F_c of the load; 3.84 N m leaves the paper's static error of 0.32 rad.";
    keys.push(Key::number("load_coulomb_nm", "N m", 3.84, LOAD_COULOMB_NM, meaning));
    let summary = "A gap with hard edges, with viscous and Coulomb friction on the load.";
    PlantModel::new("hard-coulomb", summary, keys, |release| {
        let values = release.values;
        let coulomb_nm = values.number("load_coulomb_nm")?;
        let plant = HardCoulomb::new(Mechanics::of(values)?, coulomb_nm, values.integer("substeps")?)?;
        Ok(Box::new(RunningPlant::released(plant, release.start)))
    })
}

/// Parameters of the plant with a hard gap and Coulomb friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HardCoulomb {
    mechanics: Mechanics,
    load_coulomb_nm: f64,
    substeps: u32,
}

/// The mode, which selects the right-hand side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HardCoulombMode {
    contact: Contact,
    load_friction: DryFriction,
}

/// Coordinates and mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HardCoulombState {
    x: Vector6<f64>,
    mode: HardCoulombMode,
    torque_nm: f64,
}

impl SavedState for HardCoulombState {
    fn save(&self, numbers: &mut Vec<f64>) {
        self.x.save(numbers);
        self.mode.contact.save(numbers);
        self.mode.load_friction.save(numbers);
        self.torque_nm.save(numbers);
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        let x = SavedState::restored(numbers)?;
        let contact = SavedState::restored(numbers)?;
        let load_friction = SavedState::restored(numbers)?;
        let mode = HardCoulombMode { contact, load_friction };
        Some(Self { x, mode, torque_nm: SavedState::restored(numbers)? })
    }
}

/// What may end a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HardCoulombGuard {
    /// Contact at a flank begins or ends.
    Flank(Flank),
    /// The load sticks or breaks away.
    LoadFriction,
}

impl HardCoulomb {
    /// A plant with `load_coulomb_nm` of dry friction F_c on the load, integrated in `substeps` substeps per step.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn new(mechanics: Mechanics, load_coulomb_nm: f64, substeps: u32) -> Result<Self, ParameterError> {
        mechanics.validate()?;
        in_range("load_coulomb_nm", load_coulomb_nm, &LOAD_COULOMB_NM)?;
        validate_substeps(substeps)?;
        Ok(Self { mechanics, load_coulomb_nm, substeps })
    }

    fn transmitted_torque_nm(&self, x: &Vector6<f64>, contact: Contact) -> f64 {
        match contact {
            Contact::Gap => 0.0,
            side => {
                self.mechanics.stiffness_nm_rad
                    * (self.mechanics.twist_rad(x) - side.sign() * self.mechanics.dead_zone_rad)
            }
        }
    }

    /// Friction of a load at rest.
    fn friction_at_rest(&self, x: &Vector6<f64>, contact: Contact) -> DryFriction {
        DryFriction::at_rest(self.drive_nm(x, contact), [self.load_coulomb_nm; 2])
    }

    /// Torque that drives the load against its friction, N0 C, in N m.
    fn drive_nm(&self, x: &Vector6<f64>, contact: Contact) -> f64 {
        self.mechanics.ratio * self.transmitted_torque_nm(x, contact)
    }

    #[inline]
    fn rates(&self, x: &Vector6<f64>, mode: HardCoulombMode, torque_nm: f64) -> Vector6<f64> {
        let transmitted = self.transmitted_torque_nm(x, mode.contact);
        let dry = mode.load_friction.sign() * self.load_coulomb_nm;
        let mut rates = self.mechanics.rates(x, transmitted, torque_nm, dry);
        if mode.load_friction == DryFriction::Stick {
            rates[LOAD_POSITION] = 0.0;
            rates[LOAD_VELOCITY] = 0.0;
        }
        rates
    }
}

impl HybridSystem for HardCoulomb {
    type State = Vector6<f64>;
    type Mode = HardCoulombMode;
    type Stride = f64;
    type Guard = HardCoulombGuard;
    const GUARDS: &'static [HardCoulombGuard] = &[
        HardCoulombGuard::Flank(Flank::Lower),
        HardCoulombGuard::Flank(Flank::Upper),
        HardCoulombGuard::LoadFriction,
    ];

    fn stride(&self, h_s: f64) -> f64 {
        h_s
    }

    #[inline]
    fn flow(&self, x: &Vector6<f64>, mode: HardCoulombMode, torque_nm: f64, h_s: f64) -> Vector6<f64> {
        runge_kutta(x, h_s, &|x: &Vector6<f64>, _| self.rates(x, mode, torque_nm))
    }

    fn guard(&self, guard: HardCoulombGuard, x: &Vector6<f64>, mode: HardCoulombMode) -> f64 {
        let twist = self.mechanics.twist_rad(x);
        let half_gap = self.mechanics.dead_zone_rad;
        match (guard, mode.contact) {
            (HardCoulombGuard::Flank(Flank::Lower), Contact::Gap) => twist + half_gap,
            (HardCoulombGuard::Flank(Flank::Lower), Contact::Negative) => -half_gap - twist,
            (HardCoulombGuard::Flank(Flank::Upper), Contact::Gap) => half_gap - twist,
            (HardCoulombGuard::Flank(Flank::Upper), Contact::Positive) => twist - half_gap,
            // From one flank the other is reached through the gap only.
            (HardCoulombGuard::Flank(_), Contact::Negative | Contact::Positive) => half_gap,
            (HardCoulombGuard::LoadFriction, contact) => {
                let limits_nm = [self.load_coulomb_nm; 2];
                mode.load_friction.guard(x[LOAD_VELOCITY], self.drive_nm(x, contact), limits_nm)
            }
        }
    }

    fn switch(
        &self,
        guard: HardCoulombGuard,
        x: &mut Vector6<f64>,
        mode: HardCoulombMode,
    ) -> HardCoulombMode {
        match guard {
            HardCoulombGuard::LoadFriction => {
                let load_friction = match (mode.load_friction, mode.contact) {
                    (DryFriction::Stick, Contact::Negative) => DryFriction::SlipNegative,
                    (DryFriction::Stick, Contact::Gap | Contact::Positive) => DryFriction::SlipPositive,
                    (DryFriction::SlipNegative | DryFriction::SlipPositive, contact) => {
                        self.friction_at_rest(x, contact)
                    }
                };
                x[LOAD_VELOCITY] = 0.0;
                HardCoulombMode { load_friction, ..mode }
            }
            HardCoulombGuard::Flank(flank) => {
                let side = flank.side();
                x[MOTOR_POSITION] =
                    self.mechanics.ratio * x[LOAD_POSITION] + side.sign() * self.mechanics.dead_zone_rad;
                let contact = if mode.contact == Contact::Gap { side } else { Contact::Gap };
                HardCoulombMode { contact, ..mode }
            }
        }
    }

    fn settle(&self, x: &mut Vector6<f64>, mode: HardCoulombMode, _torque_nm: f64) -> HardCoulombMode {
        if x[LOAD_VELOCITY] == 0.0 {
            HardCoulombMode { load_friction: self.friction_at_rest(x, mode.contact), ..mode }
        } else {
            mode
        }
    }

    fn is_in_range(&self, x: &Vector6<f64>) -> bool {
        are_in_range(x)
    }
}

impl TwoMass for HardCoulomb {
    type State = HardCoulombState;

    fn initial_state(&self, start: Start) -> HardCoulombState {
        let x = start.coordinates();
        let contact = Contact::outside(self.mechanics.twist_rad(&x), self.mechanics.dead_zone_rad);
        let load_friction =
            DryFriction::released(x[LOAD_VELOCITY], self.drive_nm(&x, contact), [self.load_coulomb_nm; 2]);
        HardCoulombState { x, mode: HardCoulombMode { contact, load_friction }, torque_nm: 0.0 }
    }

    fn step(&self, state: &mut HardCoulombState, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        integrator::advance(self, &mut state.x, &mut state.mode, torque_nm, dt_s, self.substeps)?;
        state.torque_nm = torque_nm;
        Ok(())
    }

    fn positions(&self, state: &HardCoulombState) -> Positions {
        coordinates::positions(state.x.as_slice())
    }

    fn truth(&self, state: &HardCoulombState) -> Truth {
        // At a flank, rounding may leave the twist an ulp inside the gap; even then the contact must not pull.
        let side = state.mode.contact.sign();
        let transmitted =
            side * libm::fmax(side * self.transmitted_torque_nm(&state.x, state.mode.contact), 0.0);
        let elastic = 0.5 * transmitted * transmitted / self.mechanics.stiffness_nm_rad;
        let load_friction = state.mode.load_friction;
        let load_dry_friction_nm = match load_friction {
            DryFriction::Stick => self.mechanics.ratio * transmitted,
            slip => slip.sign() * self.load_coulomb_nm,
        };
        Truth {
            load_friction,
            load_dry_friction_nm,
            ..self.mechanics.truth(&state.x, state.torque_nm, transmitted, elastic, state.mode.contact)
        }
    }
}
