//! Options that state the quality of the encoders.

use clap::Args;
use lashloop_plant::encoder::MAX_ECCENTRICITY_RAD;

/// Largest errors of both encoders within a turn.
#[derive(Args)]
pub(crate) struct EncoderErrors {
    /// Largest error of the motor encoder within a turn, in rad of its shaft [default: that of the rig, else 0.03; in HIL
    /// mode that of the scenario]
    #[arg(long, value_name = "RAD", value_parser = error_rad, allow_negative_numbers = true)]
    motor_encoder_error: Option<f64>,

    /// Largest error of the load encoder within a turn, in rad of its shaft [default: that of the rig, else 0.01; in HIL
    /// mode that of the scenario]
    #[arg(long, value_name = "RAD", value_parser = error_rad, allow_negative_numbers = true)]
    load_encoder_error: Option<f64>,
}

impl EncoderErrors {
    /// The options; where one is absent the rig, and without that the default.
    pub(crate) fn or(&self, of_rig: [Option<f64>; 2], default: [f64; 2]) -> [f64; 2] {
        let options = [self.motor_encoder_error, self.load_encoder_error];
        [0, 1].map(|at| options[at].or(of_rig[at]).unwrap_or(default[at]))
    }
}

fn error_rad(text: &str) -> Result<f64, String> {
    let rad: f64 = text.parse().map_err(|_| format!("{text:?} isn't a number"))?;
    let range = 0.0..=MAX_ECCENTRICITY_RAD;
    range.contains(&rad).then_some(rad).ok_or_else(|| format!("{rad} is outside 0 to {MAX_ECCENTRICITY_RAD}"))
}
