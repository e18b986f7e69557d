//! The rig file: port, drive, encoders, power stage, limits and loader of one bench with hardware.

use std::path::{Path, PathBuf};

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::device::kinds::native::NativeTwin;
use lashloop_bench::scenario::declare::{
    Field as _, any_text, choice, integer, number, plain, section, section_of, skipped, text,
};
use lashloop_bench::scenario::key::Keys;
use lashloop_bench::scenario::range::positive;
use lashloop_bench::scenario::{ScenarioErrors, Section, settings_file};
use lashloop_bench::settings;
use lashloop_firmware::drive::PinParameters;
use lashloop_firmware::law::ParameterGroup as _;
use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MAX_ECCENTRICITY_RAD, MIN_COUNTS_PER_REV};
use lashloop_protocol::enums::ParameterValue;

use super::way::Way;

/// Speed of a serial port, in bit/s.
const BAUD: u32 = 921_600;
/// Longest time of a silent host in bench mode, unless the rig has another.
const WATCHDOG_US: u32 = 100_000;
/// Largest limit of the twist in bench mode, unless the rig has another: the paper's soft shaft twists by 12 rad.
const TWIST_RAD: f64 = 20.0;
/// Smallest scale of the drive, in both directions.
const SMALLEST_SCALE_NM: f64 = 1e-3;

const PAGE: &str = "\
# Rig files

A rig file describes one bench with hardware. This page lists its keys. It is generated from the declarations of the reader:
`lashloop rig keys` prints it, `lashloop rig keys --schema` prints [rig.schema.json](rig.schema.json). Changes belong to
`host/src/rig/file.rs`. [using-a-rig.md](using-a-rig.md) has an example and the rules of use.

- The reader rejects an unknown key and a value out of range, with file, line, allowed values and remedy.
- A scenario can't exceed `[limits]`: a higher limit in the scenario is an error before the run, and an absent one becomes the
  smaller of the drive's default and the limit of the rig.
- `[encoders]` and `[power_stage]` are parameters of a drive with pins. A run in bench mode rejects a drive that lacks one of them; a run
  in HIL mode sets those that the drive has.
- Bench mode needs `torque_per_duty_nm`: the scale of a scenario belongs to another amplifier.
- \"Needed\" in the column of defaults marks a key that a rig file has to give; a dash marks one that may be absent.
";

/// Parses the name of a device.
pub type ParseDevice<'a> = &'a dyn Fn(&str) -> Result<DeviceChoice, String>;

settings! {
    /// A bench with hardware.
    #[derive(Debug, Clone)]
    pub struct Rig with(parse: ParseDevice<'_>) {
        /// The file as the user named it.
        pub file: PathBuf = skipped(|_| PathBuf::new()),
        /// One line for reports.
        pub title: String = text("a text in quotes"),
        /// Who is responsible for the rig. Messages that need this person name it.
        pub contact: String = text("a name in quotes"),
        /// Name of the board, as the drive reports it in the handshake. A drive on another board is rejected.
        pub board: String = text("the name of a board in quotes, such as \"stm32f405\""),
        /// How the drive is reached.
        pub port: Port = section_of(|port| Port::read(port, parse)),
        /// Encoders on the pins of the drive. An absent key leaves the drive's default.
        pub encoders: Encoders = section(plain),
        /// Power stage of the drive. An absent key leaves the drive's default.
        pub power_stage: PowerStage = section(PowerStage::checked),
        /// Limits of the bench hardware. A scenario can't exceed them.
        pub limits: Limits = section(plain),
        /// How `lashloop flash` reaches the chip.
        pub loader: Loader = section(plain),
    }
}

settings! {
    /// `[port]`: how the drive is reached.
    #[derive(Debug, Clone)]
    pub struct Port with(parse: ParseDevice<'_>) {
        /// Device of the drive, as after `--device`: a name under `/dev/serial/by-id`, `tcp:HOST:PORT` or `rfc2217:HOST:PORT`. A name
        /// that another adapter can take, such as `/dev/ttyUSB0`, is an error.
        pub(crate) device: DeviceChoice = text("the name of a device in quotes, such as \"/dev/serial/by-id/usb-...\"")
            .map(move |_, port| device(port, parse)),
        /// Speed of a serial port. Other lines ignore it.
        pub baud: u32 = integer(1200..=12_000_000).or(BAUD),
    }
}

impl Port {
    /// The device without the limits of the rig: for a handshake, a description, flashing. A run takes the rig as a whole, by
    /// [`Execution`](crate::Execution).
    #[must_use]
    pub fn without_limits(&self) -> &DeviceChoice {
        &self.device
    }
}

settings! {
    /// `[encoders]`: the encoders on the pins of the drive.
    #[derive(Debug, Clone, Default, PartialEq)]
    pub struct Encoders {
        /// Counts per revolution of the motor, after quadrature.
        pub motor_counts_per_rev: Option<u32> = integer(MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV).optional(),
        /// Counts per revolution of the load, after quadrature.
        pub load_counts_per_rev: Option<u32> = integer(MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV).optional(),
        /// Sign of the motor encoder.
        pub motor_direction: Option<Direction> = choice().optional(),
        /// Sign of the load encoder.
        pub load_direction: Option<Direction> = choice().optional(),
        /// Largest error of the motor encoder within a turn, as of a disk off its axis; `commission` alone reads it.
        pub motor_error_rad: Option<f64> = number(0.0..=MAX_ECCENTRICITY_RAD).optional(),
        /// The same of the load encoder.
        pub load_error_rad: Option<f64> = number(0.0..=MAX_ECCENTRICITY_RAD).optional(),
        /// Longest pulse on a channel that is noise: 119 beside a bridge. A longer filter lowers the largest speed.
        pub filter_ns: Option<u32> = integer(0..=2666).optional(),
    }
}

settings! {
    /// Sign of an encoder.
    pub enum Direction {
        /// counts rise with the position
        "normal" => Normal,
        /// counts fall with the position
        "reversed" => Reversed,
    }
}

settings! {
    /// `[power_stage]`: from torque to duty. The levels of enable, ready and fault pins are those of the board's file.
    #[derive(Debug, Clone, Default, PartialEq)]
    pub struct PowerStage {
        /// What the outputs of the drive mean to the power stage.
        pub mode: Option<StageMode> = choice().optional(),
        /// Frequency of the pulse-width modulation.
        pub frequency_hz: Option<u32> = integer(100..=20_000).optional(),
        /// Torque at the motor for a duty of 1 more than `duty_offset`; negative if the amplifier turns the other way. At
        /// an offset of 0.5, full duty has half of it.
        pub torque_per_duty_nm: Option<f64> = number(-1e5..=1e5).optional(),
        /// Duty of no torque.
        pub duty_offset: Option<f64> = number(0.0..=1.0).optional(),
        /// Smallest duty of the amplifier, at most `duty_offset`.
        pub duty_min: Option<f64> = number(0.0..=1.0).optional(),
        /// Largest duty of the amplifier, at least `duty_offset`.
        pub duty_max: Option<f64> = number(0.0..=1.0).optional(),
    }
}

settings! {
    /// Mode of a power stage, by the names of the drive's parameter.
    pub enum StageMode {
        /// one pulse, whose duty is the command of a servo amplifier
        "amplifier" => Amplifier,
        /// a pulse for the size of the torque, and a level for its direction
        "pwm-dir" => PwmDirection,
        /// two inputs, a pulse at that of the direction; the motor coasts between pulses
        "two-pwm-coast" => TwoPwmCoast,
        /// two inputs, low pulses at that against the direction; the motor brakes between pulses
        "two-pwm-brake" => TwoPwmBrake,
        /// two half-bridges against each other, with a dead time
        "complementary" => Complementary,
    }
}

settings! {
    /// `[limits]`: limits of the bench hardware.
    #[derive(Debug, Clone, PartialEq)]
    pub struct Limits {
        /// Largest torque at the motor, in both directions. Limit of the drive's parameter `torque_limit_nm`.
        pub torque_nm: f64 = number(positive(1000.0)),
        /// Largest speed of the motor, in both directions. Limit of the drive's parameter `motor_speed_limit_rad_s`, beyond which
        /// the drive latches a fault.
        pub motor_speed_rad_s: Option<f64> = number(positive(1e6)).optional(),
        /// Largest speed of the load, in both directions. Limit of the reference, except for steps, and of the drive's parameter
        /// `load_speed_limit_rad_s`.
        pub load_speed_rad_s: Option<f64> = number(positive(1e6)).optional(),
        /// Largest distance of the load from zero, in both directions. A reference beyond it is an error; in bench mode, a load
        /// beyond it ends the run.
        pub load_travel_rad: f64 = number(positive(1e4)),
        /// Bench mode: limit of the drive's parameter `watchdog_us`, after which a silent host ends the run.
        pub watchdog_us: u32 = integer(1000..=1_000_000).or(WATCHDOG_US),
        /// Bench mode: limit of the drive's parameter `twist_limit_rad`, beyond which an encoder counts as lost. Choose
        /// little more than gap and shaft explain.
        pub twist_rad: f64 = number(positive(1e4)).or(TWIST_RAD),
    }
}

settings! {
    /// `[loader]`: how firmware gets onto the chip.
    #[derive(Debug, Clone, Default, PartialEq, Eq)]
    pub struct Loader {
        /// The way; absent for the first available one, in this order.
        pub via: Option<Way> = choice().optional(),
        /// The chip, as probe-rs names it; that of the image's board if absent.
        pub chip: Option<String> = any_text(),
        /// The debug probe, as `VID:PID:SERIAL`; absent for the only one.
        pub probe: Option<String> = any_text(),
        /// Path of the terminal at PA9 and PA10 or PB10 and PB11 of the chip, where its ROM loader listens; that of the drive if absent.
        /// Only with this key a drive is requested to enter its loader for `uart`.
        pub port: Option<PathBuf> = any_text().map(|path, _| path.map(PathBuf::from)),
    }
}

impl Rig {
    /// Reads a rig file.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML, or has keys that are unknown, missing or out of range; all errors at once.
    pub fn from_file(path: &Path, parse: ParseDevice<'_>) -> Result<Self, ScenarioErrors> {
        let text = settings_file::read_text(path, "rig file")?;
        Self::from_text(&path.to_string_lossy(), &text, parse)
    }

    /// Reads a text. `name` is the file's name in errors.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file), except for reading the file.
    pub fn from_str(name: &str, text: &str) -> Result<Self, ScenarioErrors> {
        Self::from_text(name, text, PARSE)
    }

    fn from_text(name: &str, text: &str, parse: ParseDevice<'_>) -> Result<Self, ScenarioErrors> {
        let rig = settings_file::from_str(name, text, |root| Self::read(root, parse))?;
        Ok(Self { file: name.into(), ..rig })
    }

    /// Every key of a rig file.
    #[must_use]
    pub fn keys() -> Keys {
        Section::keys_of(|root| Self::read(root, PARSE))
    }

    /// The page `docs/rig.md`.
    #[must_use]
    pub fn page() -> String {
        Self::keys().to_page(PAGE)
    }

    /// The schema `docs/rig.schema.json`.
    #[must_use]
    pub fn json_schema() -> serde_json::Value {
        Self::keys().to_json_schema_of("Lashloop rig")
    }
}

/// The devices of the bench.
const PARSE: ParseDevice<'static> = &|text| text.parse();

/// The device; one that stands in for a faulty one until the file is rejected.
fn device(port: &Section<'_>, parse: ParseDevice<'_>) -> DeviceChoice {
    let Some(text) = port.text("device") else { return NativeTwin.into() };
    if ["/dev/ttyUSB", "/dev/ttyACM"].iter().any(|start| text.starts_with(start)) {
        let reason = "is a name that another adapter can take after a reconnect; write the name under \
                      /dev/serial/by-id that `lashloop doctor` prints";
        port.reject("device", reason);
    }
    let reason = match parse(text) {
        Ok(device) if device.may_be_hardware() => return device,
        Ok(_) => {
            "is a simulator, and a rig is hardware: write a name under /dev/serial/by-id, tcp:HOST:PORT or \
                  rfc2217:HOST:PORT; for a simulator omit --rig"
                .to_owned()
        }
        Err(problem) => format!("isn't a device: {problem}"),
    };
    port.reject("device", reason);
    NativeTwin.into()
}

impl PowerStage {
    fn checked(self, stage: &mut Section<'_>) -> Self {
        if self.torque_per_duty_nm.is_some_and(|scale_nm| scale_nm.abs() < SMALLEST_SCALE_NM) {
            let reason = format!(
                "is too small to produce torque; abs(torque_per_duty_nm) must be >= {SMALLEST_SCALE_NM} N m"
            );
            stage.reject("torque_per_duty_nm", reason);
        }
        let offset_of_mode = match self.mode {
            None | Some(StageMode::Amplifier) => None,
            Some(StageMode::Complementary) => Some(0.5),
            Some(StageMode::PwmDirection | StageMode::TwoPwmCoast | StageMode::TwoPwmBrake) => Some(0.0),
        };
        let mut this = self;
        if let Some(offset) = offset_of_mode {
            if this.duty_offset.is_some_and(|given| given != offset) {
                stage.reject(
                    "duty_offset",
                    format!("must be {offset} in this mode, or absent: any other duty is a torque"),
                );
            }
            this.duty_offset = Some(offset);
            this.duty_min = this.duty_min.or((offset == 0.0).then_some(0.0));
        }
        let [min, offset, max] =
            [("duty_min", this.duty_min), ("duty_offset", this.duty_offset), ("duty_max", this.duty_max)]
                .map(|(name, given)| given.unwrap_or_else(|| pin_default(name)));
        if min > offset || offset > max {
            stage.reject_section(format!(
                "has duty_min = {min}, duty_offset = {offset}, duty_max = {max}, defaults of the drive included; the offset is the \
                 duty of no torque and lies between the others"
            ));
        }
        this
    }
}

/// Default of a number among the parameters of bench mode; NaN for any other name.
#[must_use]
pub fn pin_default(name: &str) -> f64 {
    let parameter = PinParameters::TABLE.iter().find(|parameter| parameter.name == name);
    match parameter.map(|parameter| parameter.range.default()) {
        // Decimal, as it is written: neither precision has 0.1.
        Some(ParameterValue::F32(default)) => default.to_string().parse().unwrap_or(f64::NAN),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests;
