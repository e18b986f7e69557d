//! What identification works from: the period, the torques and the counts of a motion.

use std::f64::consts::TAU;

/// What is known of the instruments. Counts alone can't show any of it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Instruments {
    /// Counts of the motor encoder per revolution, after quadrature.
    pub motor_counts_per_rev: u32,
    /// Counts of the load encoder per revolution, after quadrature.
    pub load_counts_per_rev: u32,
    /// Time from a sample to the arrival of its torque at the motor.
    pub torque_delay_us: u32,
    /// Standard deviation of that time, as a systematic error.
    #[serde(default)]
    pub torque_delay_deviation_us: u32,
    /// Step of the torque at the motor, in N m: the torque of a sample is off by up to half of it. 0 is exact.
    #[serde(default)]
    pub torque_step_nm: f64,
    /// Amplitude of the noise of both encoders in counts: edges jitter uniformly by up to this in either direction. 0 is none.
    #[serde(default)]
    pub noise_counts: f64,
    /// Largest error of motor and load encoder within a turn, in rad of its shaft: an eccentric one shows up to this more or
    /// less. 0 is exact.
    #[serde(default = "Instruments::unstated_encoder_error_rad")]
    pub encoder_error_rad: [f64; 2],
}

impl Instruments {
    /// Largest error of motor and load encoder of which nothing is stated, in rad: disks of 20 and of 60 mm in diameter that
    /// are 0.3 mm off their axis.
    pub const UNSTATED_ENCODER_ERROR_RAD: [f64; 2] = [0.03, 0.01];

    fn unstated_encoder_error_rad() -> [f64; 2] {
        Self::UNSTATED_ENCODER_ERROR_RAD
    }

    /// The same with encoders that may be off by this.
    #[must_use]
    pub fn with_encoder_error_rad(self, encoder_error_rad: [f64; 2]) -> Self {
        Self { encoder_error_rad, ..self }
    }

    /// Instruments whose torque and encoders are exact.
    #[must_use]
    pub fn exact(motor_counts_per_rev: u32, load_counts_per_rev: u32, torque_delay_us: u32) -> Self {
        Self {
            motor_counts_per_rev,
            load_counts_per_rev,
            torque_delay_us,
            torque_delay_deviation_us: 0,
            torque_step_nm: 0.0,
            noise_counts: 0.0,
            encoder_error_rad: [0.0; 2],
        }
    }

    pub(crate) fn motor_counts_per_rad(&self) -> f64 {
        f64::from(self.motor_counts_per_rev) / TAU
    }

    pub(crate) fn load_counts_per_rad(&self) -> f64 {
        f64::from(self.load_counts_per_rev) / TAU
    }
}

/// How a motion begins that an offset of the torque would move without one.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Held {
    /// Torque that the drive train rests under, in N m.
    pub torque_nm: f64,
    /// Time at the start of the record in which it comes to rest under that torque, in s.
    pub lead_in_s: f64,
}

/// One motion that begins at rest: without torque on the motor, or under the torque that holds the drive train.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    period_us: u32,
    torque_nm: Vec<f64>,
    motor_counts: Vec<i64>,
    load_counts: Vec<i64>,
    held_nm: f64,
}

/// Why a series can't be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeriesError {
    /// The columns have different lengths.
    #[error("{torques} torques, {motor} motor counts, {load} load counts; a series has as many of each")]
    Lengths {
        /// Number of torques.
        torques: usize,
        /// Number of readings of the motor encoder.
        motor: usize,
        /// Number of readings of the load encoder.
        load: usize,
    },
    /// Too short for any estimate.
    #[error("{samples} samples; a series needs at least {} of them", Series::SAMPLES_MIN)]
    Short {
        /// Number of samples.
        samples: usize,
    },
    /// A torque isn't a number.
    #[error("the torque of sample {sample} is {torque_nm} N m; it must be finite")]
    Torque {
        /// From 0.
        sample: usize,
        /// The torque.
        torque_nm: f64,
    },
    /// A period outside the range of drives.
    #[error("the period is {period_us} us; it must be 100 to 100000 us")]
    Period {
        /// The period.
        period_us: u32,
    },
}

impl Series {
    /// Fewest samples of a series.
    pub const SAMPLES_MIN: usize = 100;

    /// A motion that begins at rest without torque. The torque of a sample is the one that the drive answered to its counts.
    ///
    /// # Errors
    /// The columns differ in length, are too short, or have a torque that is not finite; the period is out of range.
    pub fn new(
        period_us: u32,
        torque_nm: Vec<f64>,
        motor_counts: Vec<i64>,
        load_counts: Vec<i64>,
    ) -> Result<Self, SeriesError> {
        let [torques, motor, load] = [torque_nm.len(), motor_counts.len(), load_counts.len()];
        if torques != motor || torques != load {
            return Err(SeriesError::Lengths { torques, motor, load });
        }
        if torques < Self::SAMPLES_MIN {
            return Err(SeriesError::Short { samples: torques });
        }
        if !(100..=100_000).contains(&period_us) {
            return Err(SeriesError::Period { period_us });
        }
        if let Some((sample, &torque_nm)) = torque_nm.iter().enumerate().find(|(_, it)| !it.is_finite()) {
            return Err(SeriesError::Torque { sample, torque_nm });
        }
        Ok(Self { period_us, torque_nm, motor_counts, load_counts, held_nm: 0.0 })
    }

    /// The part after the lead-in of a motion that begins at rest under a torque. What moved the drive train before isn't known.
    ///
    /// # Errors
    /// That part is too short, or the torque isn't finite.
    pub fn held(self, held: Held) -> Result<Self, SeriesError> {
        let Held { torque_nm, lead_in_s } = held;
        if !torque_nm.is_finite() {
            return Err(SeriesError::Torque { sample: 0, torque_nm });
        }
        let lead_in = ((lead_in_s / self.period_s()).round().max(0.0) as usize).min(self.torque_nm.len());
        let of = |counts: &[i64]| counts[lead_in..].to_vec();
        let after = self.torque_nm[lead_in..].to_vec();
        let series = Self::new(self.period_us, after, of(&self.motor_counts), of(&self.load_counts))?;
        Ok(Self { held_nm: torque_nm, ..series })
    }

    /// Control period in s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        f64::from(self.period_us) / 1e6
    }

    pub(crate) fn period_us(&self) -> u32 {
        self.period_us
    }

    /// Torque of each sample in N m.
    #[must_use]
    pub fn torque_nm(&self) -> &[f64] {
        &self.torque_nm
    }

    /// The torque that holds the drive train at rest before the first sample, in N m.
    pub(crate) fn held_nm(&self) -> f64 {
        self.held_nm
    }

    /// Readings of the motor encoder.
    #[must_use]
    pub fn motor_counts(&self) -> &[i64] {
        &self.motor_counts
    }

    /// Readings of the load encoder.
    #[must_use]
    pub fn load_counts(&self) -> &[i64] {
        &self.load_counts
    }

    /// Largest torque in N m, without its sign.
    pub(crate) fn peak_nm(&self) -> f64 {
        self.torque_nm.iter().fold(0.0, |peak: f64, torque_nm| peak.max(torque_nm.abs()))
    }
}
