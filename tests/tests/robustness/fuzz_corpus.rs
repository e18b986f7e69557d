//! The committed seeds of the fuzzers: they are current, and those of the drive reach every state, request and outcome.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{FaultCode, Outcome, State};
use lashloop_protocol::message::{Arm, SetParameter, Start};
use lashloop_protocol::{DriveMessage, HostMessage, Message, PROTOCOL_VERSION};

use crate::action::Action;
use crate::invariants::{CheckedDrive, Observer, Step};
use crate::seeds::{markdown, seeds};
use crate::transitions::Cause;

#[test]
fn the_committed_seeds_match_the_examples() {
    let stale: Vec<_> = seeds().into_iter().filter(|seed| !seed.is_committed()).collect();
    assert!(stale.is_empty(), "stale: {stale:?}; write them by `cargo run -p tests --example fuzz_seeds`");
}

/// Row of the table of states, state before, and the cell.
type Cell = (String, String, String);

fn cell(row: &str, before: &str, result: &str) -> Cell {
    (row.to_owned(), before.to_owned(), result.to_owned())
}

/// What the replay of a corpus reached.
#[derive(Default)]
struct Reached {
    /// Number of the present session.
    session: Option<u32>,
    cells: BTreeSet<Cell>,
    faults: BTreeSet<String>,
}

impl Reached {
    /// The rows of the table for a request. In `Boot` both rows of a number hold; a drive that latched its fault before any
    /// handshake has no session, so every number is another.
    fn rows(&self, before: State, request: &HostMessage) -> Vec<String> {
        let name = request.layout().name;
        let another = format!("{name}, another session");
        match request {
            HostMessage::Hello(hello) if hello.protocol_version != PROTOCOL_VERSION => {
                vec![format!("{name}, another version")]
            }
            HostMessage::Hello(hello) if self.session == Some(hello.session) => {
                vec![format!("{name}, same session")]
            }
            HostMessage::Hello(_) => vec![another],
            HostMessage::SetParameter(SetParameter { index, .. }) if is_live(*index) => {
                vec![format!("{name}, live")]
            }
            HostMessage::Arm(Arm { session }) | HostMessage::Start(Start { session }) => match self.session {
                None if before == State::Boot => vec![name.to_owned(), another],
                Some(present) if present == *session => vec![name.to_owned()],
                Some(_) | None => vec![another],
            },
            _ => vec![name.to_owned()],
        }
    }
}

impl Observer for Reached {
    fn step(&mut self, step: &Step<'_>) {
        let reports = step.sent.iter().filter_map(|message| match message {
            DriveMessage::FaultReport(report) => Some(format!("{:?}", report.code)),
            _ => None,
        });
        self.faults.extend(reports);
        let Cause::Request(request) = step.cause else { return };
        let outcomes = step.sent.iter().filter_map(|message| match message {
            DriveMessage::CommandResult(result) => Some(result.outcome),
            DriveMessage::ParameterReport(report) => Some(report.outcome),
            _ => None,
        });
        let result = outcomes
            .filter(|outcome| *outcome != Outcome::Accepted)
            .map(|outcome| format!("{outcome:?}"))
            .next()
            .unwrap_or_else(|| format!("-> {:?}", step.after));
        for row in self.rows(step.before, request) {
            self.cells.insert((row, format!("{:?}", step.before), result.clone()));
        }
        match request {
            HostMessage::Hello(hello) if hello.protocol_version == PROTOCOL_VERSION => {
                self.session = Some(hello.session);
            }
            HostMessage::Reset(_) => self.session = None,
            _ => {}
        }
    }
}

fn is_live(index: u8) -> bool {
    Laws::PARAMETERS.get(usize::from(index)).is_some_and(|parameter| parameter.live)
}

/// Every cell of the table, and the outcomes of the rules below it and of sections 7, 9 and 10. Not among them is what the Lashloop
/// drive can't show: it has at most 13 signals.
fn cells_of_the_page() -> BTreeSet<Cell> {
    let states = State::ALL.iter().map(|state| format!("{state:?}")).collect::<Vec<_>>();
    let mut cells = BTreeSet::new();
    for row in markdown::table(markdown::section("## 6. States"), "request") {
        let row_cells = states.iter().zip(&row[1..]).filter(|(_, result)| *result != "no session yet");
        cells.extend(row_cells.map(|(before, result)| cell(&row[0], before, result)));
    }
    for before in &states {
        let with_index = [
            "DescribeParameter",
            "GetParameter",
            "SetParameter",
            "DescribeLaw",
            "DescribeSignal",
            "DescribeChoice",
        ];
        cells.extend(with_index.map(|request| cell(request, before, "UnknownIndex")));
    }
    cells.extend(["Idle", "Armed", "Running"].map(|before| cell("Subscribe", before, "UnknownIndex")));
    // Sections 18 and 19: this drive has neither pins nor boot loader.
    for request in ["Reference", "EnterLoader"] {
        cells.extend(states.iter().map(|before| cell(request, before, "WrongState")));
    }
    // Sections 20 and 21: it has neither a store nor pins.
    for request in ["StoreParameters", "RecallParameters", "ForgetParameters", "SetZero"] {
        cells.extend(states.iter().map(|before| cell(request, before, "UnknownRequest")));
    }
    cells.extend(["Boot", "Faulted"].map(|before| cell("Capture", before, "WrongState")));
    cells.extend(["Idle", "Armed", "Running"].map(|before| cell("Capture", before, &format!("-> {before}"))));
    cells.extend(states.iter().map(|before| cell("ReadCapture", before, "NotCaptured")));
    cells.extend([
        cell("SetParameter", "Idle", "WrongType"),
        cell("SetParameter", "Idle", "OutOfRange"),
        cell("Arm", "Idle", "Inconsistent"),
        cell("Arm", "Idle", "SignalOfOtherLaw"),
        cell("Subscribe", "Armed", "SignalOfOtherLaw"),
        cell("Subscribe", "Running", "SignalOfOtherLaw"),
        cell("EncoderSample", "Running", "OutOfSequence"),
        cell("EncoderSample", "Running", "-> Faulted"),
        cell("ClearFault", "Faulted", "-> Boot"),
    ]);
    cells
}

#[test]
fn the_seeds_of_the_drive_reach_every_cell_of_the_state_table() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/drive");
    let (mut cells, mut faults) = (BTreeSet::new(), BTreeSet::new());
    for entry in fs::read_dir(folder).expect("the corpus") {
        let path = entry.expect("an entry").path();
        // What a fuzzer has found here isn't part of the repository.
        if path.extension().is_none_or(|extension| extension != "seed") {
            continue;
        }
        let history = fs::read(path).expect("a seed");
        let (mut drive, mut rest) = (CheckedDrive::<Reached>::new(), &history[..]);
        while let Some(action) = Action::read(&mut rest) {
            drive.act(&action);
        }
        cells.extend(drive.observer.cells);
        faults.extend(drive.observer.faults);
    }
    let page = cells_of_the_page();
    let [missing, not_allowed] = [page.difference(&cells), cells.difference(&page)].map(Vec::from_iter);
    assert!(missing.is_empty(), "no seed has {missing:#?}");
    assert!(not_allowed.is_empty(), "the page has no {not_allowed:#?}");
    // From `Panic` on they are those of a halt, and of bench mode, which this drive doesn't offer.
    let codes = FaultCode::ALL.iter().filter(|code| code.byte() < FaultCode::Panic.byte());
    let codes = codes.map(|code| format!("{code:?}"));
    assert_eq!(faults, codes.collect());
}
