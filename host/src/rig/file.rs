//! The rig file: port, drive, encoders, power stage, limits and loader of one bench with hardware.

use std::path::{Path, PathBuf};

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::device::kinds::native::NativeTwin;
use lashloop_bench::scenario::key::{Choice, Keys};
use lashloop_bench::scenario::range::positive;
use lashloop_bench::scenario::{ScenarioErrors, Section, settings_file};
use lashloop_plant::encoder::{MAX_COUNTS_PER_REV, MIN_COUNTS_PER_REV};

use crate::flash::way::Way;

/// Speed of a serial port, in bit/s.
const BAUD: u32 = 921_600;
/// The chip of the boards that Lashloop supports, as probe-rs names it.
const CHIP: &str = "STM32F405RGTx";

const PAGE: &str = "\
# Rig files

A rig file describes one bench with hardware. This page lists its keys. It is generated from the declarations of the reader:
`lashloop rig keys` prints it, `lashloop rig keys --schema` prints [rig.schema.json](rig.schema.json). Changes belong to
`host/src/rig/file.rs`. [bench-drive.md](bench-drive.md#rig) has an example and the rules of use.

- The reader rejects an unknown key and a value out of range, with file, line, allowed values and remedy.
- A scenario can't exceed `[limits]`: a higher limit in the scenario is an error before the run, and an absent one becomes the
  smaller of the drive's default and the limit of the rig.
- `[encoders]` and `[power_stage]` are parameters of a drive with pins. A drive without pins lacks them, and a run leaves them out.
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

/// `[power_stage]`: from torque to duty, and the polarity of the pins.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PowerStage {
    pub torque_per_duty_nm: Option<f64>,
    pub duty_offset: Option<f64>,
    pub duty_min: Option<f64>,
    pub duty_max: Option<f64>,
    pub enable_level: Option<Level>,
    pub fault_level: Option<Level>,
}

/// `[limits]`: what the bench bears.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Largest torque at the motor, either way.
    pub torque_nm: f64,
    /// Largest speed of the motor, either way.
    pub motor_speed_rad_s: Option<f64>,
    /// Largest speed of the load, either way.
    pub load_speed_rad_s: Option<f64>,
    /// Largest distance of the reference from zero, either way.
    pub load_travel_rad: f64,
}

/// `[loader]`: how firmware gets onto the chip.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loader {
    /// `None` for the first way that is there.
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

/// Level of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    High,
    Low,
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
        limits: root.doc("What the bench bears. A scenario can't exceed it.").section("limits", read_limits),
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
        parse(text).map_err(|problem| port.reject("device", format!("is no device: {problem}"))).ok()
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
    let levels = [("high", Level::High), ("low", Level::Low)];
    let mut number = |doc, key, unit, low, high| stage.doc(doc).optional_number(key, unit, low..=high);
    let settings = PowerStage {
        torque_per_duty_nm: number(
            "Torque at the motor from the centre of the duty to full duty; negative if the amplifier turns the other way.",
            "torque_per_duty_nm",
            "N m",
            -1000.0,
            1000.0,
        ),
        duty_offset: number(
            "Duty that the centre is displaced by at zero torque.",
            "duty_offset",
            "",
            -0.5,
            0.5,
        ),
        duty_min: number("Smallest duty that the amplifier takes.", "duty_min", "", 0.0, 0.5),
        duty_max: number("Largest duty that the amplifier takes.", "duty_max", "", 0.5, 1.0),
        enable_level: stage
            .doc("Level of the enable pin that switches the amplifier on.")
            .optional_choice("enable_level", &levels),
        fault_level: stage
            .doc("Level of the fault pin by which the amplifier reports a fault.")
            .optional_choice("fault_level", &levels),
    };
    if settings.torque_per_duty_nm == Some(0.0) {
        stage.reject("torque_per_duty_nm", "gives no torque at any duty; it must not be 0 N m".to_owned());
    }
    settings
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
            .doc("Largest distance of the reference from zero, either way.")
            .number("load_travel_rad", None, positive(1e4)),
    }
}

fn read_loader(loader: &mut Section<'_>) -> Loader {
    let ways: Vec<_> = Way::ALL.iter().map(|way| (way.name(), *way)).collect();
    let docs = Way::ALL.iter().map(|way| Choice { name: way.name(), doc: way.meaning() }).collect();
    Loader {
        via: loader
            .doc("The way; absent for the first one that is there, in this order.")
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
            .doc("Path of the terminal at USART1 or USART3 of the chip, where its ROM loader listens; that of the drive if absent.")
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
mod tests {
    use std::fs;

    use super::*;

    const SHORTEST: &str = "title = \"t\"\ncontact = \"c\"\nboard = \"b\"\n[port]\ndevice = \"/dev/serial/by-id/x\"\n\
                            [limits]\ntorque_nm = 5.0\nload_travel_rad = 4.0\n";

    fn document(name: &str) -> String {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    #[test]
    fn page_and_schema_list_the_keys_of_the_reader() {
        assert!(
            document("rig.md").trim_end() == Rig::page().trim_end(),
            "stale: lashloop rig keys > docs/rig.md"
        );
        let schema: serde_json::Value = serde_json::from_str(&document("rig.schema.json")).unwrap();
        assert!(schema == Rig::json_schema(), "stale: lashloop rig keys --schema > docs/rig.schema.json");
    }

    #[test]
    fn the_example_of_the_documents_is_a_rig() {
        let page = document("bench-drive.md");
        let example =
            page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
        let rig = Rig::from_str("rig.toml", example).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(rig.encoders.load_direction, Some(Direction::Reversed));
        assert_eq!(rig.loader.via, Some(Way::Dfu));
    }

    #[test]
    fn an_absent_section_leaves_the_defaults_of_the_drive() {
        let rig = Rig::from_str("rig.toml", SHORTEST).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!((rig.encoders, rig.power_stage), (Encoders::default(), PowerStage::default()));
        assert_eq!((rig.port.baud, rig.loader), (BAUD, Loader::default()));
    }

    #[test]
    fn every_error_of_a_file_is_reported_with_its_line() {
        let wrong = SHORTEST
            .replace("torque_nm = 5.0", "torque_nm = 0.0")
            .replace("contact = \"c\"\n", "")
            .replace("/dev/serial/by-id/x", "/dev/ttyACM0")
            + "[power_stage]\ntorque_per_duty_nm = 0\nduty_mn = 0.1\n[loader]\nvia = \"jtag\"\n";
        let errors = Rig::from_str("rig.toml", &wrong).expect_err("a faulty file").to_string();
        insta::assert_snapshot!(errors);
    }
}
