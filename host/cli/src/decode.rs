//! `lashloop decode`: the frames of a raw byte stream or of a capture.

use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use lashloop::Bench;
use lashloop_bench::regular_file;
use lashloop_bench::verdict::Exit;
use lashloop_decode::capture::{pcapng, reader};
use lashloop_decode::{Entry, PacketReader, StreamReader, json, table};
use lashloop_protocol::Counters;

use super::error::CliError;

/// Decode the frames of a raw byte stream or of a .pcapng capture
///
/// The stream may mix both directions. A bad frame is printed with its error, and the last line counts frames and errors.
/// Exit code 2 if not one frame is good.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Raw bytes of a serial line, or a capture of `run --capture`; - is standard input
    file: PathBuf,

    /// Print one JSON object per line instead of a table
    #[arg(long)]
    json: bool,
}

/// Most bytes of a capture, which is decoded as a whole.
const LARGEST_CAPTURE: u64 = 1 << 30;

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let unreadable = |source: io::Error| CliError::Input { path: self.file.clone(), source };
        let mut source: Box<dyn Read> = if self.file == Path::new("-") {
            Box::new(io::stdin().lock())
        } else {
            Box::new(open(&self.file).map_err(unreadable)?)
        };
        let mut head = Vec::new();
        source.by_ref().take(pcapng::MAGIC.len() as u64).read_to_end(&mut head).map_err(unreadable)?;
        let mut printer = Printer {
            out: BufWriter::new(io::stdout().lock()),
            json: self.json,
            counted: Counters::default(),
            is_empty: true,
        };
        let printed = if head == pcapng::MAGIC {
            source.by_ref().take(LARGEST_CAPTURE).read_to_end(&mut head).map_err(unreadable)?;
            if head.len() as u64 > LARGEST_CAPTURE {
                let text = "a capture may have 1 GiB; cut it, as by editcap -c";
                return Err(unreadable(io::Error::new(io::ErrorKind::FileTooLarge, text)));
            }
            printer.capture(&head, &self.file)?
        } else {
            printer.stream(&head, &mut source, &self.file)?
        };
        let counters = printer.counted;
        match printed {
            // A closed pipe (`| head`) is not an error.
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                Err(CliError::System { what: "print", source: error })
            }
            // Not one message: another file, or an empty one.
            _ if counters.messages + counters.unknown + counters.refused == 0 => {
                Err(CliError::NoMessage { path: self.file.clone() })
            }
            _ => Ok(Exit::Pass),
        }
    }
}

/// Opens a file or a terminal. A pipe is standard input: by its name it would keep the program waiting for a writer.
fn open(path: &Path) -> io::Result<File> {
    if regular_file::other_kind(path)? == Some("a pipe") {
        return Err(io::Error::other("it is a pipe; name it as standard input: `lashloop decode - <PIPE`"));
    }
    File::open(path)
}

struct Printer<W: Write> {
    out: BufWriter<W>,
    json: bool,
    /// All frames, at the end.
    counted: Counters,
    /// Whether there was nothing to decode.
    is_empty: bool,
}

/// The inner error is that of the output.
type Printed = Result<io::Result<()>, CliError>;

impl<W: Write> Printer<W> {
    fn stream(&mut self, head: &[u8], source: &mut dyn Read, path: &Path) -> Printed {
        let mut reader = StreamReader::default();
        let mut printed = self.heading(false);
        let mut buffer = [0; 1 << 16];
        self.is_empty = head.is_empty();
        reader.push(head, |entry| self.entry(&entry, &mut printed));
        while printed.is_ok() {
            match source.read(&mut buffer) {
                Ok(0) => break,
                Ok(count) => {
                    reader.push(&buffer[..count], |entry| self.entry(&entry, &mut printed));
                    // Flushed per read, so that a live line can be watched.
                    printed = printed.and_then(|()| self.out.flush());
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(source) => return Err(CliError::Input { path: path.to_owned(), source }),
            }
        }
        reader.finish(|entry| self.entry(&entry, &mut printed));
        Ok(printed.and_then(|()| self.counters(reader.decoder.counters())))
    }

    fn capture(&mut self, bytes: &[u8], path: &Path) -> Printed {
        self.is_empty = false;
        let mut reader = PacketReader::default();
        let mut printed = self.heading(true);
        let mut broken = None;
        for packet in reader::packets(bytes) {
            match packet {
                Ok(packet) => reader.push(&packet, |entry| self.entry(&entry, &mut printed)),
                Err(error) => broken = Some(error),
            }
            if printed.is_err() {
                return Ok(printed);
            }
        }
        printed = printed.and_then(|()| self.counters(reader.decoder.counters()));
        match broken {
            Some(error) => Err(CliError::Input { path: path.to_owned(), source: io::Error::other(error) }),
            None => Ok(printed),
        }
    }

    fn heading(&mut self, capture: bool) -> io::Result<()> {
        if self.json { Ok(()) } else { writeln!(self.out, "{}", table::heading(capture)) }
    }

    fn entry(&mut self, entry: &Entry, printed: &mut io::Result<()>) {
        if printed.is_ok() {
            *printed = if self.json {
                json::line(entry).map_err(io::Error::from).and_then(|line| writeln!(self.out, "{line}"))
            } else {
                writeln!(self.out, "{}", table::line(entry))
            };
        }
    }

    fn counters(&mut self, counters: &Counters) -> io::Result<()> {
        self.counted = *counters;
        let line = if self.json { json::counters(counters) } else { table::counters(counters) };
        writeln!(self.out, "{line}")?;
        self.out.flush()
    }
}
