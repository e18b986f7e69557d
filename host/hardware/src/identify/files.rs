//! The estimates as a table, as a scenario's plant and as parameters of a drive.

use std::fmt::Write as _;

use lashloop_bench::scenario::RunMode;
use lashloop_identify::electrical::Motor;
use lashloop_identify::{
    CONFIDENCE, Direction, EncoderError, Estimate, Held, Identified, Instruments, Quantity, Source,
};
use lashloop_plant::backlash_shaft;

/// The plant in the format of a scenario.
pub const PLANT_FILE: &str = "plant.toml";
/// The parameters of a drive, for `lashloop parameters restore`.
pub const DRIVE_FILE: &str = "drive.toml";
/// The motor at a bridge, as parameters of the drive.
pub const MOTOR_FILE: &str = "motor.toml";
/// Everything as JSON, for `lashloop run --gate`.
pub const ESTIMATES_FILE: &str = "estimates.json";

/// In the record of each motion: what was given of it.
pub const INSTRUMENTS_FILE: &str = "instruments.json";

/// Contents of [`INSTRUMENTS_FILE`].
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub struct GivenOfMotion {
    /// What was given of the instruments.
    #[serde(flatten)]
    pub instruments: Instruments,
    /// The torque that the motion began under, if an offset would have moved the drive train.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held: Option<Held>,
}

/// Digits of an estimate: to a thirtieth of its interval.
fn digits(estimate: &Estimate, value: f64) -> String {
    if estimate.low == estimate.high {
        return format!("{value:?}");
    }
    let half = 0.5 * (estimate.high - estimate.low).abs().max(f64::MIN_POSITIVE);
    let size = estimate.value.abs().max(half);
    let digits = ((size / half).log10() + 1.5).ceil().clamp(2.0, 10.0) as usize;
    let places = digits as i32 - 1 - size.max(f64::MIN_POSITIVE).log10().floor() as i32;
    if (0..=9).contains(&places) {
        format!("{value:.*}", places as usize)
    } else {
        format!("{value:.*e}", digits - 1)
    }
}

/// An estimate as a number.
pub(super) fn shown(estimate: &Estimate) -> String {
    digits(estimate, estimate.value)
}

/// Its interval as a text.
pub(super) fn interval(estimate: &Estimate) -> String {
    format!("{} to {}", digits(estimate, estimate.low), digits(estimate, estimate.high))
}

/// The table on standard output.
#[must_use]
pub fn table(identified: &Identified) -> String {
    let percent = 100.0 * identified.confidence;
    let direction = |it: Option<Direction>| match it {
        Some(Direction::Forward) => "forward",
        Some(Direction::Reverse) => "reverse",
        None => "not observable in this record",
    };
    let mut text = String::new();
    let mut line = |name: &str, value: &str, rest: &str| table_line(&mut text, name, value, rest);
    line("quantity", "estimate", &format!("{percent:.0} % interval"));
    line("motor_direction", direction(identified.directions.motor), "");
    line("load_direction", direction(identified.directions.load), "");
    for quantity in &identified.quantities {
        quantity_line(quantity, &mut line);
    }
    let [motor, load] = identified.residual_counts;
    let followed = if identified.is_followed() {
        "the model follows the record to the quantisation"
    } else {
        "the model does not follow the record; the intervals are those of the nearest model"
    };
    for (encoder, error) in ["motor", "load"].into_iter().zip(identified.encoder_errors) {
        let EncoderError { stated_rad, source } = error;
        let source = match source {
            _ if stated_rad == 0.0 => "exact within a turn, as given",
            Source::Fitted => "its eccentricity is fitted",
            Source::Given => {
                "too little of a turn to fit its eccentricity; the intervals have the given error"
            }
        };
        let _ = writeln!(text, "{encoder} encoder: {source} (up to {stated_rad} rad given)");
    }
    let _ = writeln!(text, "\nresiduals: {motor:.2} counts of the motor, {load:.2} of the load: {followed}");
    text
}

fn table_line(text: &mut String, name: &str, value: &str, rest: &str) {
    let _ = writeln!(text, "{}", format!("{name:<26} {value:>13}  {rest}").trim_end());
}

fn quantity_line(quantity: &Quantity, line: &mut impl FnMut(&str, &str, &str)) {
    let Quantity { name, unit, meaning, estimate, .. } = quantity;
    match estimate {
        Some(it) => {
            let interval = format!("{} to {} {unit}", digits(it, it.low), digits(it, it.high));
            line(name, &digits(it, it.value), &format!("{interval:<36} {meaning}"));
        }
        None => line(name, "-", &format!("{:<36} {meaning}", "not observable in this record")),
    }
}

/// The table of a motor on standard output.
#[must_use]
pub fn motor_table(motor: &Motor) -> String {
    let mut text = String::new();
    table_line(&mut text, "quantity", "estimate", &format!("{:.0} % interval", 100.0 * CONFIDENCE));
    for quantity in motor.quantities() {
        quantity_line(&quantity, &mut |name, value, rest| table_line(&mut text, name, value, rest));
    }
    if motor.is_encoder_reversed {
        text += "the motor encoder counts against the bridge: reverse motor_direction or torque_direction\n";
    }
    text
}

/// The parameters of a drive for its motor, with intervals as comments.
#[must_use]
pub fn motor_toml(motor: &Motor) -> String {
    let mut text = String::new();
    for Quantity { drive_parameter, unit, estimate, .. } in motor.quantities() {
        if let (Some(name), Some(it)) = (drive_parameter, estimate) {
            let [value, low, high] = [it.value, it.low, it.high].map(|value| digits(&it, value));
            let _ = writeln!(text, "{:<44} # {low} to {high} {unit}", format!("{name} = {value}"));
        }
    }
    text
}

/// The plant of a scenario, with intervals as comments. What the record doesn't show keeps the value of the start.
#[must_use]
pub fn plant_toml(identified: &Identified) -> String {
    let percent = 100.0 * identified.confidence;
    let mut text = format!(
        "# Estimates of `lashloop`, with {percent:.0} % intervals as comments.\n\n[plant]\nmodel = \"{}\"\n",
        backlash_shaft::NAME
    );
    let torque_delay_us = identified.instruments.torque_delay_us;
    for quantity in &identified.quantities {
        let Some(key) = quantity.plant_key else { continue };
        let _ = match &quantity.estimate {
            Some(it) => {
                let [value, low, high] = [it.value, it.low, it.high].map(|value| digits(it, value));
                let remark = format!("{low} to {high} {}", quantity.unit);
                writeln!(text, "{:<44} # {}", format!("{key} = {value}"), remark.trim_end())
            }
            None => {
                let start = format!("{key} = {:?}", identified.likely(quantity.name).unwrap_or(f64::NAN));
                writeln!(text, "{start:<44} # not observable in this record: near the start of the fit")
            }
        };
    }
    let _ = writeln!(text, "{:<44} # given, not estimated", format!("torque_delay_us = {torque_delay_us}"));
    text += &encoders(identified, "\n[encoders]\n");
    for name in ["motor_eccentricity_rad", "load_eccentricity_rad"] {
        let Some(it) = identified.quantity(name).and_then(|it| it.estimate).filter(|it| it.low > 0.0) else {
            continue;
        };
        let [value, low, high] = [it.value, it.low, it.high].map(|value| digits(&it, value));
        let _ = writeln!(text, "{:<44} # {low} to {high} rad", format!("{name} = {value}"));
    }
    text
}

fn encoders(identified: &Identified, heading: &str) -> String {
    let instruments = identified.instruments;
    format!(
        "{heading}{:<44} # given, not estimated\n{:<44} # given, not estimated\n",
        format!("motor_counts_per_rev = {}", instruments.motor_counts_per_rev),
        format!("load_counts_per_rev = {}", instruments.load_counts_per_rev),
    )
}

/// How the drive is used that takes the estimates.
#[derive(Debug, Clone, Copy)]
pub struct DriveUse {
    /// HIL mode or bench mode: in HIL mode nothing shows the encoders at the pins.
    pub mode: RunMode,
    /// The drive's `torque_limit_nm`, of which its parameters `torque_offset_deviation` and `torque_ripple_deviation` are fractions.
    pub torque_limit_nm: f64,
}

/// A parameter of a drive with where it is from.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveParameter {
    /// Its name.
    pub name: &'static str,
    /// Its value in TOML.
    pub value: String,
    /// Its interval, or what it follows from.
    pub remark: String,
    /// Whether it holds after the drive's next start.
    pub lasts: bool,
}

/// The parameters of a drive's laws that follow from the estimates. `offers` has the names of the drive's parameters.
#[must_use]
pub fn drive_parameters(
    identified: &Identified,
    of: DriveUse,
    offers: impl Fn(&str) -> bool,
) -> Vec<DriveParameter> {
    // An encoder without an index is at its zero wherever the drive starts, and the cogging at another phase.
    let lasts = |name: &str| of.mode.is_hil() || !name.starts_with("cogging_");
    let mut all: Vec<_> = identified
        .quantities
        .iter()
        .filter_map(|quantity| {
            let (name, it) = (quantity.drive_parameter?, quantity.estimate?);
            let [low, high] = [it.low, it.high].map(|value| digits(&it, value));
            let remark = format!("{low} to {high} {}", quantity.unit).trim_end().to_owned();
            Some(DriveParameter { name, value: digits(&it, it.value), remark, lasts: lasts(name) })
        })
        .collect();
    let doubt = identified.torque_doubt;
    let compensates = lasts("cogging_nm") && offers("cogging_nm");
    let ripple_nm = doubt.compensated_ripple_nm.filter(|_| compensates).or(doubt.ripple_nm);
    let deviations = [("torque_offset_deviation", doubt.offset_nm), ("torque_ripple_deviation", ripple_nm)];
    let limit_nm = of.torque_limit_nm;
    all.extend(deviations.into_iter().filter_map(|(name, deviation_nm)| {
        let deviation_nm = deviation_nm.filter(|_| limit_nm > 0.0)?;
        let value = format!("{:.2e}", deviation_nm / limit_nm);
        let remark = format!("{deviation_nm:.2e} N m of a torque_limit_nm of {limit_nm}");
        Some(DriveParameter { name, value, remark, lasts: true })
    }));
    let delay_s = f64::from(identified.instruments.torque_delay_us) / 1e6;
    let lag_s = identified.likely("current_lag_ms").map(|it| it / 1e3);
    all.extend(lag_s.map(|lag_s| DriveParameter {
        name: "torque_lag_s",
        value: format!("{:.6}", delay_s + lag_s),
        remark: format!("delay of {delay_s} s and lag of {lag_s:.6} s"),
        lasts: true,
    }));
    all
}

/// The parameters of a drive that are estimated, as far as `offers` has their names. Motions in HIL mode show nothing of the
/// encoders at the pins, so it has no directions then.
#[must_use]
pub fn drive_toml(identified: &Identified, of: DriveUse, offers: impl Fn(&str) -> bool) -> String {
    let mut text = "# Estimates of `lashloop`, for `lashloop parameters restore`.\n".to_owned();
    let mut line = |prefix: &str, name: &str, value: &str, remark: &str| {
        let prefix = if offers(name) { prefix } else { "# the drive lacks it: " };
        let _ = writeln!(text, "{prefix}{:<44} # {remark}", format!("{name} = {value}"));
    };
    for DriveParameter { name, value, remark, lasts } in drive_parameters(identified, of, &offers) {
        line(if lasts { "" } else { "# until the drive is switched off: " }, name, &value, &remark);
    }
    let directions =
        [("motor_direction", identified.directions.motor), ("load_direction", identified.directions.load)];
    for (name, direction) in directions {
        let word = match direction {
            Some(Direction::Forward) => "\"forward\"",
            Some(Direction::Reverse) => "\"reverse\"",
            None => continue,
        };
        if !of.mode.is_hil() {
            line("", name, word, "as the encoder is wired");
        }
    }
    text + &encoders(identified, "")
}
