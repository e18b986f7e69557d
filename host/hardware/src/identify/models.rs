//! The estimates as a model of another simulator: two inertias, a gap, a spring that only pushes, and friction.
//!
//! All quantities of shaft and gap are at the motor, as in [`plant_toml`](super::files::plant_toml): the twist is the angle of the
//! motor minus the ratio times that of the load.

use std::fmt::Write as _;

use lashloop_identify::Identified;
use lashloop_plant::Mechanics;

use super::files::{interval, shown};

/// A simulator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simulator {
    /// `MuJoCo`, by MJCF.
    Mujoco,
    /// Any tool for Modelica; without a library.
    Modelica,
    /// Simulink, by a script of MATLAB that builds the diagram.
    SimulinkScript,
}

impl Simulator {
    /// Name of the file.
    #[must_use]
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Mujoco => "drive.xml",
            Self::Modelica => "Drive.mo",
            Self::SimulinkScript => "build_drive.m",
        }
    }

    /// The model. What the motions don't show keeps its likely value, and the comment says so.
    #[must_use]
    pub fn model(self, identified: &Identified) -> String {
        match self {
            Self::Mujoco => mujoco(identified),
            Self::Modelica => modelica(identified),
            Self::SimulinkScript => simulink(identified),
        }
    }
}

/// The quantities of a model: name in the estimates, symbol, unit.
const QUANTITIES: [(&str, &str, &str); 12] = [
    ("motor_inertia_kg_m2", "J_m", "kg.m2"),
    ("motor_friction_nm_s_rad", "f_m", "N.m.s/rad"),
    ("motor_coulomb_nm", "F_m", "N.m"),
    ("load_inertia_kg_m2", "J_s", "kg.m2"),
    ("load_friction_nm_s_rad", "f_s", "N.m.s/rad"),
    ("load_coulomb_nm", "F_s", "N.m"),
    ("reduction_ratio", "N0", "1"),
    ("stiffness_nm_rad", "K", "N.m/rad"),
    ("shaft_damping_nm_s_rad", "c", "N.m.s/rad"),
    ("dead_zone_rad", "j0", "rad"),
    ("torque_offset_nm", "T_0", "N.m"),
    ("current_lag_ms", "T_i", "ms"),
];
/// Velocity within which Coulomb friction changes its sign, in rad/s.
const SIGN_RAD_S: f64 = 0.01;

/// Value and interval of a quantity, as texts.
fn quantity(identified: &Identified, name: &str) -> (String, String) {
    match identified.quantity(name).and_then(|it| it.estimate) {
        Some(estimate) => (shown(&estimate), interval(&estimate)),
        None => {
            let likely = identified.likely(name).unwrap_or(0.0);
            (format!("{likely:?}"), "not observable in the records: near the start of the fit".to_owned())
        }
    }
}

fn value(identified: &Identified, name: &str) -> String {
    quantity(identified, name).0
}

/// A time step, in s: a whole fraction of 1 ms, and at most a twentieth of the period of the shaft's mode.
fn step_s(identified: &Identified) -> f64 {
    let Mechanics { motor_inertia_kg_m2, load_inertia_kg_m2, ratio, stiffness_nm_rad, .. } =
        identified.mechanics;
    let mode_rad_s =
        (stiffness_nm_rad * (1.0 / motor_inertia_kg_m2 + ratio * ratio / load_inertia_kg_m2)).sqrt();
    let steps = (20.0 * 1e-3 * mode_rad_s / std::f64::consts::TAU).ceil().clamp(10.0, 1_000.0);
    1e-3 / steps
}

/// A hinge for each inertia. A tendon between them has the ratio, and a spring that is slack in the gap.
fn mujoco(identified: &Identified) -> String {
    let mut text = "<!-- Estimates of lashloop, with 95 % intervals:\n".to_owned();
    for (name, ..) in QUANTITIES {
        let (value, interval) = quantity(identified, name);
        let _ = writeln!(text, "     {:<40} {interval}", format!("{name} = {value}"));
    }
    let of = |name| value(identified, name);
    let [motor, load, half_gap] = ["motor_inertia_kg_m2", "load_inertia_kg_m2", "dead_zone_rad"].map(of);
    let [motor_friction, load_friction] = ["motor_friction_nm_s_rad", "load_friction_nm_s_rad"].map(of);
    let [motor_coulomb, load_coulomb] = ["motor_coulomb_nm", "load_coulomb_nm"].map(of);
    let [ratio, stiffness, damping] =
        ["reduction_ratio", "stiffness_nm_rad", "shaft_damping_nm_s_rad"].map(of);
    let step_s = step_s(identified);
    let lag_s = identified.likely("current_lag_ms").unwrap_or(0.0) / 1e3;
    // Friction is a soft constraint; these are hard enough for a load that sticks.
    let sticks = r#"solreffriction="0.001 1" solimpfriction="0.9999 0.9999 0.001 0.5 2""#;
    let _ = write!(
        text,
        r#"     The damping of a tendon acts in the gap too, that of the shaft in contact only. The offset of the torque is left out.
     Stiction, Stribeck effect, asymmetry of the friction and cogging are left out.
     The time step is at most a twentieth of the period of the shaft's mode. -->
<mujoco model="drive">
  <option timestep="{step_s}" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="motor">
      <joint name="motor" type="hinge" axis="0 0 1" damping="{motor_friction}" frictionloss="{motor_coulomb}" {sticks}/>
      <inertial pos="0 0 0" mass="1" diaginertia="{motor} {motor} {motor}"/>
    </body>
    <body name="load">
      <joint name="load" type="hinge" axis="0 0 1" damping="{load_friction}" frictionloss="{load_coulomb}" {sticks}/>
      <inertial pos="0 0 0" mass="1" diaginertia="{load} {load} {load}"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="gear" stiffness="{stiffness}" damping="{damping}" springlength="-{half_gap} {half_gap}">
      <joint joint="motor" coef="1"/>
      <joint joint="load" coef="-{ratio}"/>
    </fixed>
  </tendon>
  <actuator>
    <general name="torque_nm" joint="motor" dyntype="filterexact" dynprm="{lag_s:.6}"/>
  </actuator>
</mujoco>
"#
    );
    text
}

fn modelica(identified: &Identified) -> String {
    let mut text = "model Drive \"Estimates of lashloop, with 95 % intervals; without stiction, Stribeck effect and cogging\"\n".to_owned();
    for (name, symbol, unit) in QUANTITIES {
        let (value, interval) = quantity(identified, name);
        let declaration = format!("parameter Real {symbol}(unit = \"{unit}\") = {value}");
        let _ = writeln!(text, "  {declaration} \"{name}, {interval}\";");
    }
    let _ = write!(
        text,
        r#"  parameter Real w_0(unit = "rad/s") = {SIGN_RAD_S:?} "velocity within which Coulomb friction changes its sign";
  input Real torque_nm(unit = "N.m");
  output Real motor_position_rad(unit = "rad", start = 0);
  output Real load_position_rad(unit = "rad", start = 0);
  Real w_m(unit = "rad/s", start = 0) "velocity of the motor";
  Real w_s(unit = "rad/s", start = 0) "velocity of the load";
  Real motor_torque_nm(unit = "N.m", start = 0) "behind the lag of the current";
  Real twist_rad(unit = "rad") "at the motor";
  Real transmitted_torque_nm(unit = "N.m") "at the motor; the contact pushes and never pulls";
equation
  der(motor_position_rad) = w_m;
  der(load_position_rad) = w_s;
  1e-3 * T_i * der(motor_torque_nm) = torque_nm - motor_torque_nm;
  twist_rad = motor_position_rad - N0 * load_position_rad;
  transmitted_torque_nm = if twist_rad > j0 then max(0.0, K * (twist_rad - j0) + c * (w_m - N0 * w_s))
    else if twist_rad < -j0 then min(0.0, K * (twist_rad + j0) + c * (w_m - N0 * w_s)) else 0.0;
  J_m * der(w_m) = motor_torque_nm + T_0 - transmitted_torque_nm - f_m * w_m - F_m * tanh(w_m / w_0);
  J_s * der(w_s) = N0 * transmitted_torque_nm - f_s * w_s - F_s * tanh(w_s / w_0);
end Drive;
"#
    );
    text
}

/// A block: its library path, its name, its parameters as MATLAB texts.
type Block = (&'static str, &'static str, &'static str);

const BLOCKS: [Block; 26] = [
    ("simulink/Sources/In1", "torque_nm", ""),
    ("simulink/Continuous/Transfer Fcn", "lag", "'Numerator', '1', 'Denominator', '[1e-3*T_i 1]'"),
    ("simulink/Sources/Constant", "torque_offset", "'Value', 'T_0'"),
    ("simulink/Math Operations/Add", "motor_sum", "'Inputs', '++--'"),
    ("simulink/Math Operations/Gain", "motor_inertia", "'Gain', '1/J_m'"),
    ("simulink/Continuous/Integrator", "motor_velocity", ""),
    ("simulink/Continuous/Integrator", "motor_position", ""),
    (FRICTION, "motor_friction", "'offset', 'F_m', 'gain', 'f_m'"),
    ("simulink/Math Operations/Gain", "ratio", "'Gain', 'N0'"),
    ("simulink/Math Operations/Add", "twist", "'Inputs', '+-'"),
    ("simulink/Discontinuities/Dead Zone", "gap", "'LowerValue', '-j0', 'UpperValue', 'j0'"),
    ("simulink/Math Operations/Gain", "stiffness", "'Gain', 'K'"),
    ("simulink/Math Operations/Gain", "ratio_of_velocity", "'Gain', 'N0'"),
    ("simulink/Math Operations/Add", "twist_rate", "'Inputs', '+-'"),
    ("simulink/Math Operations/Gain", "damping", "'Gain', 'c'"),
    ("simulink/Sources/Constant", "no_contact", "'Value', '0'"),
    ("simulink/Signal Routing/Switch", "contact", "'Criteria', 'u2 ~= 0'"),
    ("simulink/Math Operations/Add", "transmitted", "'Inputs', '++'"),
    ("simulink/Math Operations/Gain", "to_load", "'Gain', 'N0'"),
    ("simulink/Math Operations/Add", "load_sum", "'Inputs', '+-'"),
    ("simulink/Math Operations/Gain", "load_inertia", "'Gain', '1/J_s'"),
    ("simulink/Continuous/Integrator", "load_velocity", ""),
    ("simulink/Continuous/Integrator", "load_position", ""),
    (FRICTION, "load_friction", "'offset', 'F_s', 'gain', 'f_s'"),
    ("simulink/Sinks/Out1", "motor_position_rad", ""),
    ("simulink/Sinks/Out1", "load_position_rad", ""),
];
const FRICTION: &str = "simulink/Discontinuities/Coulomb & Viscous Friction";
const LINES: [(&str, &str); 32] = [
    ("torque_nm/1", "lag/1"),
    ("lag/1", "motor_sum/1"),
    ("torque_offset/1", "motor_sum/2"),
    ("transmitted/1", "motor_sum/3"),
    ("motor_friction/1", "motor_sum/4"),
    ("motor_sum/1", "motor_inertia/1"),
    ("motor_inertia/1", "motor_velocity/1"),
    ("motor_velocity/1", "motor_position/1"),
    ("motor_velocity/1", "motor_friction/1"),
    ("motor_position/1", "twist/1"),
    ("load_position/1", "ratio/1"),
    ("ratio/1", "twist/2"),
    ("twist/1", "gap/1"),
    ("gap/1", "stiffness/1"),
    ("motor_velocity/1", "twist_rate/1"),
    ("load_velocity/1", "ratio_of_velocity/1"),
    ("ratio_of_velocity/1", "twist_rate/2"),
    ("twist_rate/1", "damping/1"),
    ("damping/1", "contact/1"),
    ("gap/1", "contact/2"),
    ("no_contact/1", "contact/3"),
    ("stiffness/1", "transmitted/1"),
    ("contact/1", "transmitted/2"),
    ("transmitted/1", "to_load/1"),
    ("to_load/1", "load_sum/1"),
    ("load_friction/1", "load_sum/2"),
    ("load_sum/1", "load_inertia/1"),
    ("load_inertia/1", "load_velocity/1"),
    ("load_velocity/1", "load_position/1"),
    ("load_velocity/1", "load_friction/1"),
    ("motor_position/1", "motor_position_rad/1"),
    ("load_position/1", "load_position_rad/1"),
];

fn simulink(identified: &Identified) -> String {
    let mut text =
        "% Estimates of lashloop, with 95 % intervals. Run it in MATLAB: it builds the diagram `drive`.\n% Stiction, Stribeck effect, asymmetry of the friction and cogging are left out.\n\
                    % At the end of a contact the damping may pull for a moment; the estimates are of a contact that never does.\n"
            .to_owned();
    for (name, symbol, unit) in QUANTITIES {
        let (value, interval) = quantity(identified, name);
        let _ = writeln!(text, "{:<28} % {name} in {unit}, {interval}", format!("{symbol} = {value};"));
    }
    text += "\nnew_system('drive');\n";
    for (library, name, parameters) in BLOCKS {
        let parameters = if parameters.is_empty() { String::new() } else { format!(", {parameters}") };
        let _ = writeln!(text, "add_block('{library}', 'drive/{name}'{parameters});");
    }
    for (from, to) in LINES {
        let _ = writeln!(text, "add_line('drive', '{from}', '{to}', 'autorouting', 'on');");
    }
    text += "Simulink.BlockDiagram.arrangeSystem('drive');\nopen_system('drive');\n";
    text
}
