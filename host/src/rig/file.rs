//! The rig file: port, drive, encoders, power stage, limits and loader of one bench with hardware.

use std::path::{Path, PathBuf};

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::device::kinds::native::NativeTwin;
use lashloop_bench::scenario::key::{Choice, Keys};
use lashloop_bench::scenario::range::positive;
use lashloop_bench::scenario::{ScenarioErrors, Section, settings_file};
use lashloop_firmware::drive::PinParameters;
use lashloop_firmware::law::ParameterGroup as _;
use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MIN_COUNTS_PER_REV};
use lashloop_protocol::enums::ParameterValue;

use crate::flash::way::Way;

/// Speed of a serial port, in bit/s.
const BAUD: u32 = 921_600;
/// Longest time of a silent host in bench mode, unless the rig has another.
const WATCHDOG_US: u32 = 100_000;
/// Largest limit of the twist in bench mode, unless the rig has another: the paper's soft shaft twists by 12 rad.
const TWIST_RAD: f64 = 20.0;
/// Smallest scale of the drive, either way.
const SMALLEST_SCALE_NM: f64 = 1e-3;
/// The chip of the boards that Lashloop supports, as probe-rs names it.
const CHIP: &str = "STM32F405RGTx";

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

/// A bench with hardware.
#[derive(Debug, Clone)]
pub struct Rig {
    /// The file as the user named it.
    pub file: PathBuf,
    /// One line for reports.
    pub title: String,
    /// Who is responsible for the rig.
    pub contact: String,
    /// Name of the board, as the drive reports it.
    pub board: String,
    pub port: Port,
    pub encoders: Encoders,
    pub power_stage: PowerStage,
    pub limits: Limits,
    pub loader: Loader,
}

/// `[port]`: how the drive is reached.
#[derive(Debug, Clone)]
pub struct Port {
    pub device: DeviceChoice,
    /// Bits per second of a serial port.
    pub baud: u32,
}

/// `[encoders]`: the encoders on the pins of the drive.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Encoders {
    pub motor_counts_per_rev: Option<u32>,
    pub load_counts_per_rev: Option<u32>,
    pub motor_direction: Option<Direction>,
    pub load_direction: Option<Direction>,
}

/// `[power_stage]`: from torque to duty. The levels of enable, ready and fault pins are those of the board's file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PowerStage {
    pub torque_per_duty_nm: Option<f64>,
    pub duty_offset: Option<f64>,
    pub duty_min: Option<f64>,
    pub duty_max: Option<f64>,
}

/// `[limits]`: limits of the bench hardware.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Largest torque at the motor, either way.
    pub torque_nm: f64,
    /// Largest speed of the motor, either way.
    pub motor_speed_rad_s: Option<f64>,
    /// Largest speed of the load, either way.
    pub load_speed_rad_s: Option<f64>,
    /// Largest distance of reference and load from zero, either way.
    pub load_travel_rad: f64,
    /// Bench mode: longest watchdog time of the drive.
    pub watchdog_us: u32,
    /// Bench mode: largest limit of the twist.
    pub twist_rad: f64,
}

/// `[loader]`: how firmware gets onto the chip.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loader {
    /// `None` for the first available way.
    pub via: Option<Way>,
    /// The chip, as probe-rs names it.
    pub chip: String,
    /// The debug probe, as `VID:PID:SERIAL`.
    pub probe: Option<String>,
    /// The port of the chip's ROM loader.
    pub port: Option<PathBuf>,
}

/// Sign of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Counts rise with the position.
    Normal,
    /// Counts fall with the position.
    Reversed,
}

/// Parses the name of a device.
pub type ParseDevice<'a> = &'a dyn Fn(&str) -> Result<DeviceChoice, String>;

impl Rig {
    /// Reads a rig file.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML, or has keys that are unknown, missing or out of range; all errors at once.
    pub fn from_file(path: &Path, parse: ParseDevice<'_>) -> Result<Self, ScenarioErrors> {
        settings_file::read(path, "rig file", |root| read(root, path, parse))
    }

    /// Reads a text. `name` is the file's name in errors.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file), except for reading the file.
    pub fn from_str(name: &str, text: &str) -> Result<Self, ScenarioErrors> {
        settings_file::from_str(name, text, |root| read(root, Path::new(name), &|text| text.parse()))
    }

    /// Every key of a rig file.
    #[must_use]
    pub fn keys() -> Keys {
        settings_file::keys(|root| {
            read(root, Path::new(""), &|text| text.parse());
        })
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

fn read(root: &mut Section<'_>, file: &Path, parse: ParseDevice<'_>) -> Rig {
    let mut text = |key, doc, purpose| root.doc(doc).text(key, Some(purpose)).unwrap_or_default().to_owned();
    Rig {
        file: file.to_owned(),
        title: text("title", "One line for reports.", "a text in quotes"),
        contact: text(
            "contact",
            "Who is responsible for the rig. Messages that need this person name it.",
            "a name in quotes",
        ),
        board: text(
            "board",
            "Name of the board, as the drive reports it in the handshake. A drive on another board is rejected.",
            "the name of a board in quotes, such as \"stm32f405\"",
        ),
        port: root.doc("How the drive is reached.").section("port", |section| read_port(section, parse)),
        encoders: root
            .doc("Encoders on the pins of the drive. An absent key leaves the drive's default.")
            .section("encoders", read_encoders),
        power_stage: root
            .doc("Power stage of the drive. An absent key leaves the drive's default.")
            .section("power_stage", read_power_stage),
        limits: root
            .doc("Limits of the bench hardware. A scenario can't exceed them.")
            .section("limits", read_limits),
        loader: root.doc("How `lashloop flash` reaches the chip.").section("loader", read_loader),
    }
}

fn read_port(port: &mut Section<'_>, parse: ParseDevice<'_>) -> Port {
    let text = port
        .doc("Device of the drive, as after `--device`: a name under `/dev/serial/by-id`, `tcp:HOST:PORT` or `rfc2217:HOST:PORT`. A name that another adapter can take, such as `/dev/ttyUSB0`, is an error.")
        .text("device", Some("the name of a device in quotes, such as \"/dev/serial/by-id/usb-...\""));
    let device = text.and_then(|text| {
        if ["/dev/ttyUSB", "/dev/ttyACM"].iter().any(|start| text.starts_with(start)) {
            let reason = "is a name that another adapter can take after a reconnect; write the name under \
                          /dev/serial/by-id that `lashloop ports` prints";
            port.reject("device", reason.to_owned());
        }
        let device =
            parse(text).map_err(|problem| port.reject("device", format!("is no device: {problem}"))).ok()?;
        if !device.may_be_hardware() {
            let reason = "is a simulator, and a rig is hardware: write a name under /dev/serial/by-id, tcp:HOST:PORT or \
                          rfc2217:HOST:PORT; for a simulator omit --rig";
            port.reject("device", reason.to_owned());
        }
        Some(device)
    });
    Port {
        // The stand-in of a faulty key; the file is rejected.
        device: device.unwrap_or_else(|| NativeTwin.into()),
        baud: port.doc("Speed of a serial port. Other lines ignore it.").integer(
            "baud",
            BAUD,
            1200..=12_000_000,
        ),
    }
}

fn read_encoders(encoders: &mut Section<'_>) -> Encoders {
    let range = || MIN_COUNTS_PER_REV..=MAX_COUNTS_PER_REV;
    let directions = [("normal", Direction::Normal), ("reversed", Direction::Reversed)];
    let meanings = || {
        let choice = |name, doc| Choice { name, doc };
        vec![
            choice("normal", "counts rise with the position"),
            choice("reversed", "counts fall with the position"),
        ]
    };
    Encoders {
        motor_counts_per_rev: encoders
            .doc("Counts per revolution of the motor, after quadrature.")
            .optional_integer("motor_counts_per_rev", range()),
        load_counts_per_rev: encoders
            .doc("Counts per revolution of the load, after quadrature.")
            .optional_integer("load_counts_per_rev", range()),
        motor_direction: encoders
            .doc("Sign of the motor encoder.")
            .choice_docs(meanings())
            .optional_choice("motor_direction", &directions),
        load_direction: encoders
            .doc("Sign of the load encoder.")
            .choice_docs(meanings())
            .optional_choice("load_direction", &directions),
    }
}

fn read_power_stage(stage: &mut Section<'_>) -> PowerStage {
    let mut number = |doc, key, unit, low, high| stage.doc(doc).optional_number(key, unit, low..=high);
    let settings = PowerStage {
        torque_per_duty_nm: number(
            "Torque at the motor for a duty of 1 more than `duty_offset`; negative if the amplifier turns the other way. At an offset of 0.5, full duty has half of it.",
            "torque_per_duty_nm",
            "N m",
            -1e5,
            1e5,
        ),
        duty_offset: number("Duty of no torque.", "duty_offset", "", 0.0, 1.0),
        duty_min: number("Smallest duty of the amplifier, at most `duty_offset`.", "duty_min", "", 0.0, 1.0),
        duty_max: number("Largest duty of the amplifier, at least `duty_offset`.", "duty_max", "", 0.0, 1.0),
    };
    if settings.torque_per_duty_nm.is_some_and(|scale_nm| scale_nm.abs() < SMALLEST_SCALE_NM) {
        let reason = format!(
            "gives hardly a torque at any duty; it must be {SMALLEST_SCALE_NM} N m or more, either way"
        );
        stage.reject("torque_per_duty_nm", reason);
    }
    let [min, offset, max] = [
        ("duty_min", settings.duty_min),
        ("duty_offset", settings.duty_offset),
        ("duty_max", settings.duty_max),
    ]
    .map(|(name, given)| given.unwrap_or_else(|| pin_default(name)));
    if !(min <= offset && offset <= max) {
        stage.reject_section(&format!(
            "has duty_min = {min}, duty_offset = {offset}, duty_max = {max}, defaults of the drive included; the offset is the \
             duty of no torque and lies between the others"
        ));
    }
    settings
}

/// Default of a number among the parameters of bench mode; NaN for any other name.
pub(crate) fn pin_default(name: &str) -> f64 {
    let parameter = PinParameters::TABLE.iter().find(|parameter| parameter.name == name);
    match parameter.map(|parameter| parameter.range.default()) {
        // Decimal, as it is written: 0.1 is no number of either precision.
        Some(ParameterValue::F32(default)) => default.to_string().parse().unwrap_or(f64::NAN),
        _ => f64::NAN,
    }
}

fn read_limits(limits: &mut Section<'_>) -> Limits {
    Limits {
        torque_nm: limits
            .doc("Largest torque at the motor, either way. Limit of the drive's parameter `torque_limit_nm`.")
            .number("torque_nm", None, positive(1000.0)),
        motor_speed_rad_s: limits
            .doc("Largest speed of the motor, either way. Limit of the drive's parameter `motor_speed_limit_rad_s`, beyond which the drive latches a fault.")
            .optional_number("motor_speed_rad_s", "rad/s", positive(1e6)),
        load_speed_rad_s: limits
            .doc("Largest speed of the load, either way. Limit of the reference, except for steps, and of the drive's parameter `load_speed_limit_rad_s`.")
            .optional_number("load_speed_rad_s", "rad/s", positive(1e6)),
        load_travel_rad: limits
            .doc("Largest distance of the load from zero, either way. A reference beyond it is an error; in bench mode, a load beyond it ends the run.")
            .number("load_travel_rad", None, positive(1e4)),
        watchdog_us: limits
            .doc("Bench mode: limit of the drive's parameter `watchdog_us`, after which a silent host ends the run.")
            .integer("watchdog_us", WATCHDOG_US, 1000..=1_000_000),
        twist_rad: limits
            .doc("Bench mode: limit of the drive's parameter `twist_limit_rad`, beyond which an encoder counts as lost. Choose little more than gap and shaft explain.")
            .number("twist_rad", TWIST_RAD, positive(1e4)),
    }
}

fn read_loader(loader: &mut Section<'_>) -> Loader {
    let ways: Vec<_> = Way::ALL.iter().map(|way| (way.name(), *way)).collect();
    let docs = Way::ALL.iter().map(|way| Choice { name: way.name(), doc: way.meaning() }).collect();
    Loader {
        via: loader
            .doc("The way; absent for the first available one, in this order.")
            .choice_docs(docs)
            .optional_choice("via", &ways),
        chip: loader
            .doc("The chip, as probe-rs names it; `STM32F405RGTx` if absent.")
            .text("chip", None)
            .unwrap_or(CHIP)
            .to_owned(),
        probe: loader
            .doc("The debug probe, as `VID:PID:SERIAL`; absent for the only one.")
            .text("probe", None)
            .map(str::to_owned),
        port: loader
            .doc("Path of the terminal at USART1 or USART3 of the chip, where its ROM loader listens; that of the drive if absent. Only with this key a drive is requested to enter its loader for `uart`.")
            .text("port", None)
            .map(PathBuf::from),
    }
}

impl Default for Loader {
    fn default() -> Self {
        Self { via: None, chip: CHIP.to_owned(), probe: None, port: None }
    }
}

#[cfg(test)]
mod tests;
