//! Backlash contact: the torque that shaft and gap transmit, the two flanks, and the shaft that relaxes in the gap.

use super::shaft::BacklashShaft;
use super::state::ShaftCoordinates;
use crate::coordinates::{DISSIPATED, LOAD_POSITION, LOAD_VELOCITY, MOTOR_POSITION, MOTOR_VELOCITY};
use crate::mode::{Contact, Flank};

impl BacklashShaft {
    /// Twist of the shaft itself, z - theta_b, in rad.
    pub(super) fn shaft_twist_rad(&self, at: &ShaftCoordinates) -> f64 {
        self.mechanics.twist_of(at.x[LOAD_POSITION], at.x[MOTOR_POSITION]) - at.gap_position_rad
    }

    /// Energy in the shaft in J.
    pub(super) fn shaft_energy_j(&self, at: &ShaftCoordinates) -> f64 {
        let twist_rad = self.shaft_twist_rad(at);
        0.5 * self.mechanics.stiffness_nm_rad * twist_rad * twist_rad
    }

    /// C in N m.
    pub(super) fn transmitted_torque_nm(&self, at: &ShaftCoordinates, contact: Contact) -> f64 {
        if contact == Contact::Gap { 0.0 } else { self.shaft_torque_nm(at) }
    }

    /// K (z - theta_b) + c dz/dt in N m.
    pub(super) fn shaft_torque_nm(&self, at: &ShaftCoordinates) -> f64 {
        let twist_rate = at.x[MOTOR_VELOCITY] - self.mechanics.ratio * at.x[LOAD_VELOCITY];
        self.mechanics.stiffness_nm_rad * self.shaft_twist_rad(at)
            + self.parameters.shaft_damping_nm_s_rad * twist_rate
    }

    /// Torque that drives the load against its friction in N m: N0 C + T, and that of the outer mass.
    pub(super) fn load_drive_nm(&self, at: &ShaftCoordinates, contact: Contact) -> f64 {
        let drive_nm =
            self.mechanics.ratio * self.transmitted_torque_nm(at, contact) + at.surroundings.load_torque_nm;
        self.load_mode.map_or(drive_nm, |mode| drive_nm + mode.torque_nm(at.outer, &at.x))
    }

    /// Torque that drives the motor against its friction, tau and cogging - C, in N m.
    pub(super) fn motor_drive_nm(&self, at: &ShaftCoordinates, contact: Contact) -> f64 {
        at.motor_torque_nm + self.cogging.torque_nm(at.x[MOTOR_POSITION])
            - self.transmitted_torque_nm(at, contact)
    }

    /// Guard of a flank: its distance while the gap is open, the torque that pushes on it while it is in contact.
    #[inline]
    pub(super) fn flank_guard(&self, flank: Flank, at: &ShaftCoordinates, contact: Contact) -> f64 {
        let half_gap = at.surroundings.dead_zone_rad;
        match (flank, contact) {
            (Flank::Lower, Contact::Gap) => at.gap_position_rad + half_gap,
            (Flank::Upper, Contact::Gap) => half_gap - at.gap_position_rad,
            (Flank::Lower, Contact::Negative) => -self.shaft_torque_nm(at),
            (Flank::Upper, Contact::Positive) => self.shaft_torque_nm(at),
            // From one flank the other is reached through the gap only.
            (Flank::Lower, Contact::Positive) | (Flank::Upper, Contact::Negative) => half_gap,
        }
    }

    /// The contact after the guard of `flank` has reached zero; theta_b is exactly at the flank then.
    pub(super) fn after_flank(&self, flank: Flank, at: &mut ShaftCoordinates, contact: Contact) -> Contact {
        let side = flank.side();
        at.gap_position_rad = side.sign() * at.surroundings.dead_zone_rad;
        if contact == Contact::Gap { side } else { Contact::Gap }
    }

    /// Relaxes the shaft off contact over a step from `before` to `after`, until the fraction `remaining` of its twist is
    /// left. The damping dissipates the energy that the spring releases.
    #[inline]
    pub(super) fn relax(&self, before: &ShaftCoordinates, after: &mut ShaftCoordinates, remaining: f64) {
        let before_rad = self.shaft_twist_rad(before);
        let after_rad = before_rad * remaining;
        let twist_rad = self.mechanics.twist_of(after.x[LOAD_POSITION], after.x[MOTOR_POSITION]);
        after.gap_position_rad = twist_rad - after_rad;
        after.x[DISSIPATED] +=
            0.5 * self.mechanics.stiffness_nm_rad * (before_rad - after_rad) * (before_rad + after_rad);
    }

    /// Contact of a plant released with these coordinates.
    pub(super) fn contact_at_release(&self, at: &ShaftCoordinates) -> Contact {
        let half_gap = at.surroundings.dead_zone_rad;
        let twist_rad = self.mechanics.twist_of(at.x[LOAD_POSITION], at.x[MOTOR_POSITION]);
        let shaft_nm = self.shaft_torque_nm(at);
        let side = Contact::outside(twist_rad, half_gap);
        if side.sign() * shaft_nm > 0.0 { side } else { Contact::Gap }
    }
}
