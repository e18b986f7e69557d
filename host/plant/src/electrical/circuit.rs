//! Armature, bridge and bus.

use super::parameters::{ElectricalParameters, ReverseCurrent};
use crate::exponential_decay::decay;

/// What a bridge does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bridge {
    /// Every switch is off: the current decays through the diodes into the bus, and then flows only if the back-EMF exceeds the bus.
    Off,
    /// A duty of -1 to 1: the mean voltage as a fraction of the bus.
    Driving(f64),
}

/// State of the electrical side.
#[derive(Debug, Clone, PartialEq)]
pub struct Circuit {
    parameters: ElectricalParameters,
    current_a: f64,
    bus_v: f64,
}

impl Circuit {
    /// No current, and a bus at the supply's voltage.
    #[must_use]
    pub fn new(parameters: ElectricalParameters) -> Self {
        Self { parameters, current_a: 0.0, bus_v: parameters.supply_v }
    }

    /// The parameters; a change takes effect from the next step on.
    pub fn parameters_mut(&mut self) -> &mut ElectricalParameters {
        &mut self.parameters
    }

    /// The parameters.
    #[must_use]
    pub fn parameters(&self) -> &ElectricalParameters {
        &self.parameters
    }

    /// Current of the armature in A.
    #[must_use]
    pub fn current_a(&self) -> f64 {
        self.current_a
    }

    /// Voltage of the bus in V.
    #[must_use]
    pub fn bus_v(&self) -> f64 {
        self.bus_v
    }

    /// Advances by `dt_s`, in which the motor turns at `speed_rad_s`. Returns the mean current in A.
    ///
    /// The armature is solved exactly for a constant voltage, the bus by the implicit Euler rule.
    pub fn step(&mut self, bridge: Bridge, speed_rad_s: f64, dt_s: f64) -> f64 {
        let emf_v = self.parameters.torque_constant_nm_a * speed_rad_s;
        let voltage_v = match bridge {
            Bridge::Driving(duty) => duty.clamp(-1.0, 1.0) * self.bus_v - self.dead_time_v(),
            Bridge::Off => self.diode_voltage_v(emf_v),
        };
        let mean_a = if bridge == Bridge::Off && self.current_a == 0.0 && emf_v.abs() <= self.bus_v {
            0.0
        } else {
            let before_a = self.current_a;
            let mean_a = self.step_armature(voltage_v - emf_v, dt_s);
            if bridge == Bridge::Off && before_a * self.current_a < 0.0 {
                // The diodes block at zero; until then the current falls on a nearly straight line.
                let conducting = before_a / (before_a - self.current_a);
                self.current_a = 0.0;
                0.5 * before_a * conducting
            } else {
                mean_a
            }
        };
        self.step_bus(voltage_v * mean_a / self.bus_v, dt_s);
        mean_a
    }

    /// Advances the current under a constant voltage across resistance and inductance. Returns the mean.
    fn step_armature(&mut self, driving_v: f64, dt_s: f64) -> f64 {
        let ElectricalParameters { resistance_ohm, inductance_h, .. } = self.parameters;
        let end_a = driving_v / resistance_ohm;
        let x = dt_s * resistance_ohm / inductance_h;
        let left = decay(x);
        let away_a = self.current_a - end_a;
        self.current_a = end_a + away_a * left;
        // (1 - e^-x) / x, without its cancellation near 0.
        end_a + away_a * if x < 1e-5 { 1.0 - 0.5 * x } else { (1.0 - left) / x }
    }

    fn step_bus(&mut self, drawn_a: f64, dt_s: f64) {
        let ElectricalParameters {
            supply_v, supply_resistance_ohm, bus_capacitance_f, reverse_current, ..
        } = self.parameters;
        let (storage, conductance) = (bus_capacitance_f / dt_s, 1.0 / supply_resistance_ohm);
        let with_supply_v =
            (storage * self.bus_v + conductance * supply_v - drawn_a) / (storage + conductance);
        self.bus_v = if with_supply_v > supply_v && reverse_current == ReverseCurrent::Blocked {
            // Without the supply it may also end below its voltage, by less than a step of the supply's current.
            (self.bus_v - drawn_a / storage).max(supply_v)
        } else {
            // A bus that is short of energy stops the bridge; it never turns its voltage round.
            with_supply_v.max(0.0)
        };
        self.bus_v = self.bus_v.max(1e-3);
    }

    /// What the dead time takes: against the current, and less than its ripple allows near zero.
    fn dead_time_v(&self) -> f64 {
        let ElectricalParameters { dead_time_s, pwm_hz, inductance_h, .. } = self.parameters;
        let ripple_a = self.bus_v / (8.0 * inductance_h * pwm_hz);
        2.0 * dead_time_s * pwm_hz * self.bus_v * (self.current_a / ripple_a).clamp(-1.0, 1.0)
    }

    /// The voltage at a motor whose bridge is off.
    fn diode_voltage_v(&self, emf_v: f64) -> f64 {
        if self.current_a == 0.0 { self.bus_v.copysign(emf_v) } else { self.bus_v.copysign(-self.current_a) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 2.5e-5;

    fn stiff() -> ElectricalParameters {
        ElectricalParameters {
            supply_resistance_ohm: 1e-3,
            dead_time_s: 0.0,
            ..ElectricalParameters::example()
        }
    }

    fn near(have: f64, want: f64, tolerance: f64) {
        assert!((have - want).abs() <= tolerance, "have {have}, want {want}");
    }

    #[test]
    fn a_standing_motor_follows_the_closed_form() {
        let mut circuit = Circuit::new(ElectricalParameters { bus_capacitance_f: 10.0, ..stiff() });
        let mut charge_as = 0.0;
        for step in 1..=200 {
            charge_as += circuit.step(Bridge::Driving(0.25), 0.0, STEP_S) * STEP_S;
            // 12 V at 0.5 Ohm and 0.5 mH.
            let time_s = f64::from(step) * STEP_S;
            near(circuit.current_a(), 24.0 * (1.0 - libm::exp(-time_s / 1e-3)), 0.01);
        }
        // The means are those of the closed form too: its integral.
        near(charge_as, 24.0 * (5e-3 - 1e-3 * (1.0 - libm::exp(-5.0))), 1e-4);
    }

    #[test]
    fn a_spinning_motor_draws_what_its_back_emf_leaves() {
        let mut circuit = Circuit::new(stiff());
        for (speed_rad_s, want_a) in [(50.0, 24.0), (100.0, 0.0), (150.0, -24.0)] {
            for _ in 0..2000 {
                circuit.step(Bridge::Driving(0.5), speed_rad_s, STEP_S);
            }
            near(circuit.current_a(), want_a, 0.1);
        }
    }

    #[test]
    fn the_supply_pays_for_heat_work_and_what_is_stored() {
        let parameters = ElectricalParameters { supply_resistance_ohm: 0.2, ..stiff() };
        let mut circuit = Circuit::new(parameters);
        let stored_j = |circuit: &Circuit| {
            0.5 * parameters.inductance_h * circuit.current_a() * circuit.current_a()
                + 0.5 * parameters.bus_capacitance_f * circuit.bus_v() * circuit.bus_v()
        };
        let (before_j, mut paid_j, mut spent_j, dt_s) = (stored_j(&circuit), 0.0, 0.0, 1e-7);
        for step in 0..100_000 {
            // Accelerates, brakes and rests.
            let duty = [0.8, -0.3, 0.0][step / 40_000];
            let speed_rad_s = 40.0;
            let mean_a = circuit.step(Bridge::Driving(duty), speed_rad_s, dt_s);
            let supplied_a = (parameters.supply_v - circuit.bus_v()) / parameters.supply_resistance_ohm;
            paid_j += parameters.supply_v * supplied_a * dt_s;
            spent_j += dt_s
                * (parameters.supply_resistance_ohm * supplied_a * supplied_a
                    + parameters.resistance_ohm * mean_a * mean_a
                    + parameters.torque_constant_nm_a * mean_a * speed_rad_s);
        }
        assert!(paid_j > 1.0, "{paid_j} J");
        near(paid_j, spent_j + stored_j(&circuit) - before_j, 1e-3 * paid_j);
    }

    #[test]
    fn an_open_bridge_ends_the_current_and_starts_none() {
        let mut circuit = Circuit::new(stiff());
        for _ in 0..400 {
            circuit.step(Bridge::Driving(0.5), 0.0, STEP_S);
        }
        near(circuit.current_a(), 48.0, 0.5);
        // Against 48 V: L/R ln(1 + 48 A x 0.5 Ohm / 48 V) = 0.41 ms.
        let steps = (0..).take_while(|_| circuit.step(Bridge::Off, 0.0, STEP_S) > 0.0).count();
        assert!((16..=17).contains(&steps), "{steps} steps");
        assert_eq!(circuit.step(Bridge::Off, 199.0, STEP_S), 0.0, "the back-EMF is below the bus");
        assert!(circuit.step(Bridge::Off, 210.0, STEP_S) < 0.0, "2.4 V above the bus brake");
        circuit.step(Bridge::Off, 0.0, STEP_S);
        assert_eq!(circuit.current_a(), 0.0);
        assert!(circuit.step(Bridge::Off, -210.0, STEP_S) > 0.0, "the other way round");
    }

    #[test]
    fn dead_time_costs_voltage_against_the_current_and_none_at_rest() {
        let with = ElectricalParameters { dead_time_s: 1e-6, ..stiff() };
        for (duty, lost_a) in [(0.5, 3.84), (-0.5, -3.84), (0.0, 0.0)] {
            let mut currents = [stiff(), with].map(Circuit::new);
            for circuit in &mut currents {
                for _ in 0..2000 {
                    circuit.step(Bridge::Driving(duty), 0.0, STEP_S);
                }
            }
            // 2 edges of 1 us in 50 us: 4 % of 48 V, at 0.5 Ohm.
            near(currents[0].current_a() - currents[1].current_a(), lost_a, 0.05);
        }
    }

    #[test]
    fn a_supply_that_blocks_holds_what_it_is_given() {
        let blocked = ElectricalParameters { reverse_current: ReverseCurrent::Blocked, ..stiff() };
        let mut circuit = Circuit::new(blocked);
        for _ in 0..200 {
            circuit.step(Bridge::Driving(0.5), 150.0, STEP_S);
        }
        let raised_v = circuit.bus_v();
        assert!(raised_v > 52.0, "{raised_v} V");
        for _ in 0..400 {
            circuit.step(Bridge::Off, 0.0, STEP_S);
        }
        assert!(circuit.bus_v() >= raised_v, "{} V", circuit.bus_v());
        for _ in 0..4000 {
            circuit.step(Bridge::Driving(0.5), 0.0, STEP_S);
        }
        near(circuit.bus_v(), 48.0, 0.1);
    }
}
