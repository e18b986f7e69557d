//! Seeds of the fuzzers: the pinned examples, and a few typical histories of a drive.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::message::{
    Arm, ClearFault, EmergencyStop, Hello, SetParameter, Start, Stop, Subscribe,
};
use lashloop_protocol::parameter_names::CONTROLLER;
use lashloop_protocol::{HostMessage, Message, PROTOCOL_VERSION};

#[allow(dead_code, reason = "the tests of the protocol use more of it")]
#[path = "../../../protocol/tests/wire/examples.rs"]
mod examples;

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
    decoder_seeds().into_iter().chain(drive_seeds()).collect()
}

fn name_of<M: Message>(message: &M) -> String {
    message.layout().name.to_lowercase()
}

/// Seeds of the decoder: the length of the pieces, then a stream.
fn decoder_seeds() -> Vec<Seed> {
    let seed = |name: String, piece_len: u8, stream: &[u8]| {
        Seed::new("decoder", name, [&[piece_len], stream].concat())
    };
    let (host, drive) = (examples::from_host(), examples::from_drive());
    let frames: Vec<Vec<u8>> = host.iter().map(|message| message.frame().to_vec()).collect();
    let mut seeds: Vec<Seed> = host.iter().map(|m| seed(name_of(m), 64, &m.frame())).collect();
    seeds.extend(drive.iter().map(|m| seed(name_of(m), 64, &m.frame())));
    seeds.push(seed("all_in_small_pieces".into(), 7, &frames.concat()));
    seeds.push(seed(
        "all_without_delimiters".into(),
        64,
        &frames.concat().iter().map(|&byte| byte.max(1)).collect::<Vec<_>>(),
    ));
    seeds.push(seed("all_cut".into(), 3, &frames.iter().flat_map(|f| f[2..].to_vec()).collect::<Vec<_>>()));
    seeds
}

/// Seeds of the drive: histories in the encoding of `firmware/tests/properties/action.rs`.
fn drive_seeds() -> Vec<Seed> {
    let seed = |name: &str, actions: &[Vec<u8>]| Seed::new("drive", name, actions.concat());
    let hello = request(&Hello { protocol_version: PROTOCOL_VERSION, session: 7 }.into());
    let go =
        [hello.clone(), request(&Arm { session: 7 }.into()), request(&Start { session: 7 }.into())].concat();
    let controller = Laws::PARAMETERS.iter().position(|parameter| parameter.name == CONTROLLER);
    let index = controller.expect("a drive with several laws has this parameter") as u8;
    let run = |law: u32| {
        let law = request(&SetParameter { index, value: ParameterValue::U32(law) }.into());
        let samples: Vec<u8> = (0..12_i16).flat_map(|k| sample(40 * k - 200, 10 * k, 0.5)).collect();
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
    let frame = HostMessage::from(examples::SAMPLE).frame().to_vec();
    seeds.push(seed("noise", &[go, noise(&frame[..9]), noise(&frame), noise(b"noise\0"), vec![4, 3]]));
    seeds
}

const DRAIN: [u8; 1] = [5];

fn request(message: &HostMessage) -> Vec<u8> {
    let kind = HostMessage::LAYOUTS.iter().position(|layout| layout.name == message.layout().name);
    let frame = message.frame();
    let mut stuffed = frame[..frame.len() - 1].to_vec();
    let body = lashloop_protocol::frame::open(&mut stuffed).expect("a frame of ours");
    [&[1, kind.expect("every message has a layout") as u8], &body[1..]].concat()
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
