//! Tables as ASAM MDF 4: a group of channels, all real numbers, with `time_s` as the master and the units; what happened
//! in the run as events; scenario, drive and verdict as the comment of the file.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use mdf4_rs::blocks::{
    EventBlock, EventRangeType, FileHistoryBlock, HeaderBlock, IdentificationBlock, MetadataBlock, TextBlock,
};
use mdf4_rs::writer::MdfWrite;
use mdf4_rs::{DataType, DecodedValue, Error, MdfWriter};

use crate::columns::Columns;
use crate::reader::Record;
use crate::samples::RecordedEdge;
use crate::trace::TIME;

/// Where links are in a block, in bytes from its start.
const FIRST_LINK: u64 = 24;
const HEADER: &str = "hd_block";
const HEADER_HISTORY: u64 = FIRST_LINK + 8;
const HEADER_EVENT: u64 = FIRST_LINK + 32;
const HEADER_COMMENT: u64 = FIRST_LINK + 40;
/// What is kept before it is written.
const BUFFER_BYTES: usize = 1 << 20;

/// Writes columns of a record, and its events from the first to the last time of them.
///
/// # Errors
/// The file can't be written.
pub(crate) fn write(record: &Record, columns: &Columns, path: &Path) -> Result<(), WriteError> {
    let error = |action| move |source| WriteError { path: path.to_owned(), action, source };
    let file = File::create(path).map_err(error("created"))?;
    let target = Target { file: BufWriter::with_capacity(BUFFER_BYTES, file), position: 0 };
    let written = Mf4 { file: MdfWriter::from_writer(target) }.write(record, columns);
    written
        .map_err(|failure| match failure {
            Error::IOError(source) => source,
            other => io::Error::other(other.to_string()),
        })
        .map_err(error("written"))
}

/// An event: its time, its name, whether it is an end of a range.
struct Event {
    time_ns: i64,
    name: String,
    range: EventRangeType,
    /// For the end of a range, the number of the event at which it began.
    begin: Option<usize>,
}

/// The events of a record between two times.
fn events(record: &Record, from_ns: i64, until_ns: i64) -> Vec<Event> {
    let times = record.manifest.step_times();
    let at = |step: u64| (times.at(step) - times.start_ns) as i64;
    let is_within = |time_ns: i64| (from_ns..=until_ns).contains(&time_ns);
    let mut events: Vec<Event> = Vec::new();
    let mut begun: Vec<(u32, usize)> = Vec::new();
    for RecordedEdge { step, kind, number, begins } in
        record.faults.iter().filter(|it| is_within(at(it.step)))
    {
        let place = begun.iter().position(|(it, _)| it == number);
        // The end of a fault that began before the first time is a point.
        let (range, begin) = match (begins, place) {
            (true, _) => (EventRangeType::RangeBegin, None),
            (false, Some(place)) => (EventRangeType::RangeEnd, Some(begun.remove(place).1)),
            (false, None) => (EventRangeType::Point, None),
        };
        if *begins {
            begun.push((*number, events.len()));
        }
        let edge = if *begins { "begins" } else { "ends" };
        events.push(Event {
            time_ns: at(*step),
            name: format!("fault {number}, {kind}, {edge}"),
            range,
            begin,
        });
    }
    // A fault that lasts to the last time has no end of its range.
    for (_, event) in begun {
        events[event].range = EventRangeType::Point;
    }
    let logs = record.logs.iter().filter(|it| is_within(at(it.step)));
    events.extend(logs.map(|it| Event {
        time_ns: at(it.step),
        name: it.text.clone(),
        range: EventRangeType::Point,
        begin: None,
    }));
    events
}

struct Mf4 {
    file: MdfWriter<Target>,
}

impl Mf4 {
    fn write(mut self, record: &Record, columns: &Columns) -> Result<(), Error> {
        self.head(record)?;
        self.table(columns)?;
        let time_ns = |at: Option<&f64>| at.map_or(0, |time_s| (1e9 * time_s).round() as i64);
        let time_s = columns.get(TIME).unwrap_or_default();
        self.events(&events(record, time_ns(time_s.first()), time_ns(time_s.last())))?;
        self.file.finalize()
    }

    /// What the file is of, and what made it.
    fn head(&mut self, record: &Record) -> Result<(), Error> {
        let start_time_ns = record.manifest.step_times().start_ns;
        self.file.write_block_with_id(&IdentificationBlock::default().to_bytes()?, "id_block")?;
        let header = HeaderBlock { start_time_ns, ..HeaderBlock::default() };
        let header = self.file.write_block_with_id(&header.to_bytes()?, HEADER)?;
        let version = env!("CARGO_PKG_VERSION");
        let made = format!(
            "<FHcomment><TX>lashloop export</TX><tool_id>lashloop</tool_id><tool_vendor>Lashloop</tool_vendor>\
             <tool_version>{version}</tool_version></FHcomment>"
        );
        let made = self.metadata(&made)?;
        let history = FileHistoryBlock { comment_addr: made, ..FileHistoryBlock::new(start_time_ns) };
        let history = self.file.write_block(&history.to_bytes()?)?;
        self.file.update_link(header + HEADER_HISTORY, history)?;
        let comment = format!("<HDcomment><TX>{}</TX></HDcomment>", escaped(&description(record)));
        let comment = self.metadata(&comment)?;
        self.file.update_link(header + HEADER_COMMENT, comment)
    }

    fn metadata(&mut self, xml: &str) -> Result<u64, Error> {
        self.file.write_block(&MetadataBlock::new(xml).to_bytes()?)
    }

    fn table(&mut self, columns: &Columns) -> Result<(), Error> {
        let group = self.file.add_channel_group(None, |_| {})?;
        self.file.set_channel_group_name(&group, "steps")?;
        let mut previous: Option<String> = None;
        for signal in columns.signals() {
            let channel = self.file.add_channel(&group, previous.as_deref(), |channel| {
                channel.data_type = DataType::FloatLE;
                channel.bit_count = 64;
                channel.name = Some(signal.name.to_string());
            })?;
            self.file.set_channel_unit(&channel, &signal.unit)?;
            if signal.name == TIME {
                self.file.set_time_channel(&channel)?;
            }
            previous = Some(channel);
        }
        self.file.start_data_block_for_cg(&group, 0)?;
        let mut row = Vec::with_capacity(columns.signals().len());
        for number in 0..columns.len() {
            row.clear();
            row.extend(columns.row(number).map(DecodedValue::Float));
            self.file.write_record(&group, &row)?;
        }
        self.file.finish_data_block(&group)
    }

    /// A list of events, each linked to the next one.
    fn events(&mut self, events: &[Event]) -> Result<(), Error> {
        let Some(header) = self.file.get_block_position(HEADER) else { return Ok(()) };
        let mut link = header + HEADER_EVENT;
        let mut places: Vec<u64> = Vec::with_capacity(events.len());
        for event in events {
            let name_addr = self.file.write_block(&TextBlock::new(&event.name).to_bytes()?)?;
            let block = EventBlock {
                name_addr,
                range_type: event.range,
                range_ev_addr: event.begin.map_or(0, |begin| places[begin]),
                sync_base_value: event.time_ns,
                sync_factor: 1e-9,
                ..EventBlock::marker(0.0)
            };
            let place = self.file.write_block(&block.to_bytes()?)?;
            self.file.update_link(link, place)?;
            link = place + FIRST_LINK;
            places.push(place);
        }
        Ok(())
    }
}

fn description(record: &Record) -> String {
    let manifest = &record.manifest;
    let verdict = record.summary.as_ref().map_or("interrupted".to_owned(), |it| it.verdict.to_string());
    let (scenario, drive, law) = (&manifest.scenario.name, &manifest.device_description, &manifest.law);
    format!("{scenario}; {drive}; law {law}; {verdict}")
}

/// A text within XML, which has no place for control characters.
fn escaped(text: &str) -> String {
    let is_foreign =
        |it: char| it.is_control() && !matches!(it, '\t' | '\n') || matches!(it, '\u{fffe}' | '\u{ffff}');
    let text: String = text.chars().map(|it| if is_foreign(it) { '\u{fffd}' } else { it }).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A file that is written at any place.
struct Target {
    file: BufWriter<File>,
    position: u64,
}

impl MdfWrite for Target {
    fn write_all(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.file.write_all(bytes)?;
        self.position += bytes.len() as u64;
        Ok(())
    }

    fn seek(&mut self, position: u64) -> Result<u64, Error> {
        self.position = self.file.seek(SeekFrom::Start(position))?;
        Ok(self.position)
    }

    fn position(&self) -> u64 {
        self.position
    }

    fn flush(&mut self) -> Result<(), Error> {
        Ok(self.file.flush()?)
    }
}
