//! A load of two masses: an outer mass behind a spring, and an inner one at the gear.

use core::f64::consts::TAU;

use nalgebra::SVector;

use super::parameters::LoadModeParameters;
use crate::coordinates::{DISSIPATED, LOAD_POSITION, LOAD_VELOCITY};
use crate::integrator::{Rates, Stage};

/// Position and velocity of the outer mass, after the coordinates of the plant without a load mode.
const OUTER_POSITION: usize = 7;
const OUTER_VELOCITY: usize = 8;

/// Spring and damper between the masses of the load. With the whole load's inertia J, the fraction r behind the spring,
/// w = 2 pi f and the damping ratio d: stiffness r (1 - r) J w^2, damping 2 d r (1 - r) J w.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadMode {
    outer_inertia_kg_m2: f64,
    stiffness_nm_rad: f64,
    damping_nm_s_rad: f64,
    /// w and 2 d w.
    pub(super) rates_per_s: [f64; 2],
}

/// A mass of the load in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MassState {
    pub(super) position_rad: f64,
    pub(super) velocity_rad_s: f64,
}

impl LoadMode {
    /// The mode of a load; `None` if no part of it is behind a spring.
    pub(super) fn new(of: LoadModeParameters, load_inertia_kg_m2: f64) -> Option<Self> {
        let LoadModeParameters { fraction, frequency_hz, damping_ratio } = of;
        let frequency_per_s = TAU * frequency_hz;
        let reduced_kg_m2 = fraction * (1.0 - fraction) * load_inertia_kg_m2;
        let rates_per_s = [frequency_per_s, 2.0 * damping_ratio * frequency_per_s];
        (fraction > 0.0).then_some(Self {
            outer_inertia_kg_m2: fraction * load_inertia_kg_m2,
            stiffness_nm_rad: reduced_kg_m2 * frequency_per_s * frequency_per_s,
            damping_nm_s_rad: reduced_kg_m2 * rates_per_s[1],
            rates_per_s,
        })
    }

    /// Torque of the spring and of the damper on the inner mass, in N m.
    #[inline]
    fn torques_nm(&self, outer: MassState, inner: MassState) -> [f64; 2] {
        [
            self.stiffness_nm_rad * (outer.position_rad - inner.position_rad),
            self.damping_nm_s_rad * (outer.velocity_rad_s - inner.velocity_rad_s),
        ]
    }

    /// Torque on the inner mass in N m.
    pub(super) fn torque_nm(&self, outer: MassState, x: &SVector<f64, 7>) -> f64 {
        let [spring_nm, damper_nm] = self.torques_nm(outer, inner(x));
        spring_nm + damper_nm
    }

    /// Energy in the spring in J.
    pub(super) fn elastic_j(&self, outer: MassState, load_position_rad: f64) -> f64 {
        let twist_rad = outer.position_rad - load_position_rad;
        0.5 * self.stiffness_nm_rad * twist_rad * twist_rad
    }

    /// Kinetic energy in J beyond that of a load of one mass.
    pub(super) fn kinetic_j(&self, outer: MassState, load_velocity_rad_s: f64) -> f64 {
        let [slower, faster] = [load_velocity_rad_s, outer.velocity_rad_s];
        0.5 * self.outer_inertia_kg_m2 * (faster - slower) * (faster + slower)
    }

    /// State vector of the plant with its outer mass.
    pub(super) fn joined(x: &SVector<f64, 7>, outer: MassState) -> SVector<f64, 9> {
        let mut joined = x.fixed_resize::<9, 1>(0.0);
        joined[OUTER_POSITION] = outer.position_rad;
        joined[OUTER_VELOCITY] = outer.velocity_rad_s;
        joined
    }

    /// The inverse of [`joined`](Self::joined).
    pub(super) fn parted(joined: &SVector<f64, 9>) -> (SVector<f64, 7>, MassState) {
        let outer =
            MassState { position_rad: joined[OUTER_POSITION], velocity_rad_s: joined[OUTER_VELOCITY] };
        (joined.fixed_rows::<7>(0).into_owned(), outer)
    }

    /// Rates of the plant with its outer mass. `of_plant` are those without it; `per_inner_inertia` is the reciprocal of
    /// the inner mass's inertia, 0 while it sticks.
    #[inline]
    pub(super) fn rates(&self, of_plant: &impl Rates<7>, per_inner_inertia: f64) -> impl Rates<9> {
        move |joined: &SVector<f64, 9>, stage: Stage| {
            let (x, outer) = Self::parted(joined);
            let [spring_nm, damper_nm] = self.torques_nm(outer, inner(&x));
            let on_inner_nm = spring_nm + damper_nm;
            let mut rates = of_plant.at(&x, stage).fixed_resize::<9, 1>(0.0);
            rates[LOAD_VELOCITY] += on_inner_nm * per_inner_inertia;
            rates[DISSIPATED] += damper_nm * (outer.velocity_rad_s - x[LOAD_VELOCITY]);
            rates[OUTER_POSITION] = outer.velocity_rad_s;
            rates[OUTER_VELOCITY] = -on_inner_nm / self.outer_inertia_kg_m2;
            rates
        }
    }
}

fn inner(x: &SVector<f64, 7>) -> MassState {
    MassState { position_rad: x[LOAD_POSITION], velocity_rad_s: x[LOAD_VELOCITY] }
}
