//! Seeds of the fuzzers: the pinned examples, typical histories of a drive, and every request in every state.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use lashloop_bench::run::{DriveValues, Step, TraceRow};
use lashloop_bench::timing::{StepOutcome, StepTiming};
use lashloop_decode::capture::pcapng;
use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_plant::Signal;
use lashloop_plant::metrics::SignalTable;
use lashloop_protocol::enums::{CaptureTrigger, ParameterValue, State, ZeroSource};
use lashloop_protocol::layout::Direction;
use lashloop_protocol::message::{
    Arm, Capture, ClearFault, DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, EmergencyStop,
    EnterLoader, ForgetParameters, GetParameter, Hello, ReadCapture, RecallParameters, Reference,
    SetParameter, SetZero, Start, Stop, StoreParameters, Subscribe,
};
use lashloop_protocol::parameter_names::CONTROLLER;
use lashloop_protocol::{HostMessage, Message};
use lashloop_record::samples::{SampleWriter, StepTimes};

use examples::NUMBER;

#[allow(dead_code, reason = "the tests of the protocol use more of it")]
#[path = "../../../protocol/tests/wire/examples.rs"]
mod examples;
#[allow(dead_code, reason = "the tests of the document use more of it")]
#[path = "../document/host.rs"]
mod host;
#[allow(dead_code, reason = "the tests of the document use more of it")]
#[path = "../../../protocol/tests/wire/markdown.rs"]
pub mod markdown;

const CAPTURE: Capture = Capture {
    signals: 1,
    every: 1,
    before: 2,
    trigger: CaptureTrigger::Rising,
    trigger_signal: 0,
    level: 0.5,
};

/// A file below `fuzz/corpus` and its contents.
#[derive(Debug)]
pub struct Seed {
    target: &'static str,
    name: String,
    bytes: Vec<u8>,
}

impl Seed {
    fn new(target: &'static str, name: impl Into<String>, bytes: Vec<u8>) -> Self {
        Self { target, name: name.into(), bytes }
    }

    fn path(&self) -> PathBuf {
        let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
        corpus.join(self.target).join(&self.name).with_extension("seed")
    }

    /// Whether the repository has the same bytes.
    pub fn is_committed(&self) -> bool {
        fs::read(self.path()).is_ok_and(|bytes| bytes == self.bytes)
    }

    /// Writes the file.
    #[allow(dead_code, reason = "the test only compares")]
    pub fn write(&self) -> io::Result<()> {
        let path = self.path();
        fs::create_dir_all(path.parent().unwrap_or(Path::new("")))?;
        fs::write(path, &self.bytes)
    }
}

/// Seeds of the fuzzers that read bytes. The scenario fuzzer has symbolic links to scenarios as seeds.
pub fn seeds() -> Vec<Seed> {
    [decoder_seeds(), frames_seeds(), drive_seeds(), state_seeds(), session_seeds(), file_seeds()]
        .into_iter()
        .flatten()
        .collect()
}

const RIG: &str = r#"title = "A bench"
contact = "the person next to it"
board = "nucleo-f446re"

[port]
device = "tcp:127.0.0.1:7000"

[encoders]
motor_counts_per_rev = 4096

[limits]
torque_nm = 0.5
load_travel_rad = 4.0
"#;

/// Seeds of the readers of files. Those of a campaign are symbolic links, as those of the scenarios are.
fn file_seeds() -> Vec<Seed> {
    let shard = format!("case,part,value,torque_sha256\n0,\"a,b\",1.5,{0}\n1,c,none,{0}\n", "0a".repeat(32));
    vec![
        Seed::new("record", "five_steps", recorded()),
        Seed::new("shard", "two_rows", shard.into_bytes()),
        Seed::new("rig", "board", RIG.as_bytes().to_vec()),
        Seed::new("pcapng", "conversation", captured()),
        Seed::new("elf", "vectors", linked()),
    ]
}

/// `run.mcap` of five steps in two chunks, without a signal of a plant.
fn recorded() -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let signals = SignalTable { plant: Vec::new(), drive: vec![Signal::new("load_error_rad", "rad")] };
    let times = StepTimes { start_ns: 1_000_000_007, period_us: 1000 };
    let mut writer = SampleWriter::create(folder.path(), &signals, times, 0, 3, &[]).expect("samples");
    for step in 0..5_u32 {
        let time_s = f64::from(step) * 1e-3;
        let row = TraceRow {
            time_s,
            reference_rad: 0.1,
            load_position_rad: 0.01 * time_s,
            motor_position_rad: 0.03 * time_s,
            torque_nm: 0.5,
        };
        let outcome = StepOutcome::Answered;
        let timing = StepTiming { lateness: Duration::ZERO, outcome, round_trip: None, tick_compute: None };
        let drive = DriveValues { values: [0.25].into_iter().collect(), time_s: Some(0.0) };
        let step = Step { row, sample: None, plant: [].into_iter().collect(), drive, timing };
        writer.push(&step).expect("a step");
    }
    writer.finish(("summary.json", "{}")).expect("samples");
    fs::read(folder.path().join("run.mcap")).expect("samples")
}

/// A capture of the pinned messages that a run has.
fn captured() -> Vec<u8> {
    let mut capture = pcapng::file_header();
    let host = examples::from_host()
        .into_iter()
        .map(|it| (name_of(&it), Direction::HostToDrive, it.numbered_frame(NUMBER).to_vec()));
    let drive = examples::from_drive()
        .into_iter()
        .map(|it| (name_of(&it), Direction::DriveToHost, it.numbered_frame(NUMBER).to_vec()));
    let of_run = ["start", "encodersample", "torqueanswer", "parameterreport"];
    for (_, direction, frame) in host.chain(drive).filter(|(name, ..)| of_run.contains(&&**name)) {
        pcapng::append_packet(&mut capture, 1_000_000, direction, &frame);
    }
    capture
}

/// An ELF of one segment: a vector table of a Cortex-M at the start of its flash.
fn linked() -> Vec<u8> {
    let half = |number: u16| number.to_le_bytes().to_vec();
    let word = |number: u32| number.to_le_bytes().to_vec();
    let start =
        [half(2), half(40), word(1), word(0x0800_0009), word(52), word(0), word(0x0500_0000)].concat();
    let sizes = [52, 32, 1, 40, 0, 0].map(|size: u16| half(size)).concat();
    let segment = [1, 84, 0x0800_0000, 0x0800_0000, 12, 12, 5, 4].map(word).concat();
    let vectors = [0x2000_1000, 0x0800_0009, 0xbf00_bf00].map(word).concat();
    let ident = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0";
    [&ident[..], &start, &sizes, &segment, &vectors].concat()
}

fn name_of<M: Message>(message: &M) -> String {
    message.layout().name.to_lowercase()
}

/// Of the first byte of the decoder's seeds: the stream is one for the host.
const FOR_HOST: u8 = 0x80;

/// Seeds of the decoder: direction and length of the pieces, then a stream.
fn decoder_seeds() -> Vec<Seed> {
    let seed = |name: String, piece_len: u8, stream: &[u8]| {
        Seed::new("decoder", name, [&[piece_len], stream].concat())
    };
    let (host, drive) = (examples::from_host(), examples::from_drive());
    let frames: Vec<Vec<u8>> = host.iter().map(|message| message.numbered_frame(NUMBER).to_vec()).collect();
    let mut seeds: Vec<Seed> = host.iter().zip(&frames).map(|(m, f)| seed(name_of(m), 64, f)).collect();
    seeds.extend(drive.iter().map(|m| seed(name_of(m), FOR_HOST | 64, &m.numbered_frame(NUMBER))));
    seeds.push(seed("all_in_small_pieces".into(), 7, &frames.concat()));
    seeds.push(seed(
        "all_without_delimiters".into(),
        64,
        &frames.concat().iter().map(|&byte| byte.max(1)).collect::<Vec<_>>(),
    ));
    seeds.push(seed("all_cut".into(), 3, &frames.iter().flat_map(|f| f[2..].to_vec()).collect::<Vec<_>>()));
    seeds
}

/// Seeds of the frames: one of each message, then one of each damage.
fn frames_seeds() -> Vec<Seed> {
    let frame = |head: u8, body: &[u8]| [&[head << 6 | (body.len() - 1) as u8, 20], body].concat();
    let messages = examples::from_host().iter().map(|m| (name_of(m), 64, body(m))).collect::<Vec<_>>();
    let from_drive = examples::from_drive();
    let from_drive = from_drive.iter().map(|m| (name_of(m), FOR_HOST | 64, body(m)));
    let seed = |(name, first, body): (String, u8, Vec<u8>)| {
        Seed::new("frames", name, [&[first][..], &frame(0, &body)].concat())
    };
    let arm = body(&HostMessage::from(Arm { session: 7 }));
    let damaged = (1..3).map(|damage| {
        let frames = [frame(damage, &arm), frame(0, &arm), frame(0, &arm)].concat();
        Seed::new("frames", format!("damage_{damage}"), [&[5][..], &frames].concat())
    });
    messages.into_iter().chain(from_drive).map(seed).chain(damaged).collect()
}

/// Seeds of the session: each edit of what a drive sends, at the handshake, within the descriptions and at the start.
fn session_seeds() -> Vec<Seed> {
    let edits = [
        ("drop", 0_u8),
        ("flip", 1),
        ("replace", 2),
        ("double", 4),
        ("insert", 5),
        ("noise", 6),
        ("babble", 7),
    ];
    let seed = |(name, edit): (&str, u8)| {
        let head = |passed: u8| [edit << 5 | passed, 14, 6];
        Seed::new("session", name, [head(0), head(9), head(31)].concat())
    };
    edits.map(seed).into()
}

/// Seeds of the drive: every request in every state, as the table of the specification has them, and the refusals that depend on
/// the contents of a request.
fn state_seeds() -> Vec<Seed> {
    let everywhere = |name: &str, message: HostMessage| {
        let request = request(&message);
        let name = name.to_lowercase().replace(", ", "_").replace(' ', "_");
        State::ALL.iter().zip(0_u8..).map(move |(state, index)| {
            let name = format!("{}_{name}", format!("{state:?}").to_lowercase());
            Seed::new("drive", name, [&[6, index][..], &request].concat())
        })
    };
    let rows = markdown::table(markdown::section("## 6. States"), "request");
    let names = rows.iter().map(|row| row[0].as_str());
    let unknown: [HostMessage; 6] = [
        DescribeParameter { index: u8::MAX }.into(),
        GetParameter { index: u8::MAX }.into(),
        SetParameter { index: u8::MAX, value: ParameterValue::U32(0) }.into(),
        DescribeLaw { index: u8::MAX }.into(),
        DescribeSignal { index: u8::MAX }.into(),
        DescribeChoice { parameter: u8::MAX, choice: 0 }.into(),
    ];
    let mut seeds: Vec<Seed> = names.flat_map(|name| everywhere(name, host::request(name))).collect();
    seeds.extend(unknown.iter().flat_map(|m| everywhere(&format!("unknown {}", name_of(m)), *m)));
    seeds.extend(everywhere("unknown signal", Subscribe { signals: 1 << 31, every: 1 }.into()));
    let reference = Reference { number: 1, reference_rad: 0.5 };
    seeds.extend(everywhere("reference", reference.into()));
    seeds.extend(everywhere("enter loader", EnterLoader { session: 7 }.into()));
    let options: [(&str, HostMessage); 6] = [
        ("store parameters", StoreParameters {}.into()),
        ("recall parameters", RecallParameters {}.into()),
        ("forget parameters", ForgetParameters {}.into()),
        ("set zero", SetZero { source: ZeroSource::Present }.into()),
        ("capture", CAPTURE.into()),
        ("read capture", ReadCapture { first: 0 }.into()),
    ];
    seeds.extend(options.into_iter().flat_map(|(name, message)| everywhere(name, message)));
    let stray = host::rest(5);
    seeds.extend(everywhere("stray sample", stray.into()));
    let period = |value| request(&SetParameter { index: host::index("period_us"), value }.into());
    let fast =
        SetParameter { index: host::index("motor_speed_limit_rad_s"), value: ParameterValue::F32(1e6) };
    let refused = [
        &[6, 1][..],
        &period(ParameterValue::F32(1.0)),
        &period(ParameterValue::U32(0)),
        &request(&fast.into()),
        &request(&Arm { session: host::SESSION }.into()),
    ];
    seeds.push(Seed::new("drive", "refused_values", refused.concat()));
    let not_finite = [
        &[6, 1][..],
        &request(&SetParameter { index: host::index("k_p1"), value: ParameterValue::F32(1e6) }.into()),
        &request(&SetParameter { index: host::index("k_p2"), value: ParameterValue::F32(1e6) }.into()),
        &request(&Arm { session: host::SESSION }.into()),
        &request(&Start { session: host::SESSION }.into()),
        &sample(0, 0, f32::MAX),
    ];
    seeds.push(Seed::new("drive", "torque_not_finite", not_finite.concat()));
    let of_other_law = Subscribe { signals: host::signals(&["dead_zone_deviation_rad"]), every: 1 };
    let arm = request(&Arm { session: host::SESSION }.into());
    for (name, state, then) in [("idle", 1, &arm[..]), ("armed", 2, &[][..]), ("running", 3, &[][..])] {
        let history = [&[6, state][..], &request(&of_other_law.into()), then].concat();
        seeds.push(Seed::new("drive", format!("{name}_signal_of_other_law"), history));
    }
    let fault_before_hello =
        [&[6, 0][..], &request(&EmergencyStop {}.into()), &request(&ClearFault {}.into())];
    seeds.push(Seed::new("drive", "fault_before_hello", fault_before_hello.concat()));
    seeds
}

/// Seeds of the drive: histories in the encoding of `firmware/tests/properties/action.rs`.
fn drive_seeds() -> Vec<Seed> {
    let seed = |name: &str, actions: &[Vec<u8>]| Seed::new("drive", name, actions.concat());
    let hello = request(&Hello::new(7).into());
    let go =
        [hello.clone(), request(&Arm { session: 7 }.into()), request(&Start { session: 7 }.into())].concat();
    let controller = Laws::PARAMETERS.iter().position(|parameter| parameter.name == CONTROLLER);
    let index = controller.expect("a drive with several laws has this parameter") as u8;
    let run = |law: u32| {
        let law = request(&SetParameter { index, value: ParameterValue::U32(law) }.into());
        let samples: Vec<u8> = (0..8_i16).flat_map(|k| sample(40 * k - 200, 10 * k, 0.5)).collect();
        let subscribe = request(&Subscribe { signals: 0b1_1111, every: 3 }.into());
        [hello.clone(), law, subscribe, go.clone(), samples, DRAIN.to_vec(), request(&Stop {}.into())]
            .concat()
    };
    let mut seeds: Vec<Seed> =
        examples::from_host().iter().map(|m| seed(&name_of(m), &[hello.clone(), request(m)])).collect();
    for (law, name) in (0..).zip(Laws::NAMES) {
        seeds.push(seed(&format!("run_{}", name.replace('-', "_")), &[run(law)]));
    }
    let emergency =
        [request(&EmergencyStop {}.into()), sample(1, 1, 0.0), request(&ClearFault {}.into()), go.clone()];
    seeds.push(seed("emergency", &[&[go.clone(), sample(900, 300, 0.0)][..], &emergency].concat()));
    seeds.push(seed("silence", &[go.clone(), sample(900, 300, 0.0), pass(20_001), sample(0, 0, 0.0)]));
    seeds.push(seed("not_a_number", &[go.clone(), sample(900, 300, f32::NAN)]));
    seeds.push(seed("encoder_jump", &[go.clone(), sample(0, 0, 0.0), sample(i16::MAX, 0, 0.0)]));
    seeds.push(seed("load_encoder_jump", &[go.clone(), sample(0, 0, 0.0), sample(0, i16::MAX, 0.0)]));
    let frame = HostMessage::from(examples::SAMPLE).frame().to_vec();
    seeds.push(seed("noise", &[go, noise(&frame[..9]), noise(&frame), noise(b"noise\0"), vec![4, 3]]));
    seeds
}

const DRAIN: [u8; 1] = [5];

fn request(message: &HostMessage) -> Vec<u8> {
    let kind = HostMessage::LAYOUTS.iter().position(|layout| layout.name == message.layout().name);
    [&[1, kind.expect("every message has a layout") as u8], &body(message)[1..]].concat()
}

fn body<M: Message>(message: &M) -> Vec<u8> {
    let frame = message.numbered_frame(NUMBER);
    let mut stuffed = frame[..frame.len() - 1].to_vec();
    lashloop_protocol::frame::open(&mut stuffed).expect("a frame of ours").to_vec()
}

fn sample(motor: i16, load: i16, reference_rad: f32) -> Vec<u8> {
    [&[2][..], &motor.to_le_bytes(), &load.to_le_bytes(), &reference_rad.to_le_bytes()].concat()
}

fn pass(us: u32) -> Vec<u8> {
    [&[3][..], &us.to_le_bytes()].concat()
}

fn noise(bytes: &[u8]) -> Vec<u8> {
    [&[0, bytes.len() as u8], bytes].concat()
}
