//! The parameters of a drive as a file, to be kept and brought back, and as a fingerprint.
//!
//! The file is TOML, a line per parameter in the order of the wire's indices, with unit and range as comments. Real numbers
//! are written with as many digits as bring back the same bits.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use lashloop_protocol::enums::ParameterValue;
use sha2::{Digest, Sha256};
use toml_edit::{Document, Item, Value};

use lashloop_bench::session::{Parameter, Session, SessionError, SetError};

/// All parameters of a drive with the values in force, in the order of their index.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSet(Vec<(Parameter, ParameterValue)>);

impl ParameterSet {
    /// Asks the drive for every value in force.
    ///
    /// # Errors
    /// The conversation broke.
    pub fn read(session: &mut Session) -> Result<Self, SessionError> {
        let parameters = session.parameters().to_vec();
        let valued = parameters.into_iter().map(|it| session.get(it.index).map(|value| (it, value)));
        valued.collect::<Result<_, _>>().map(Self)
    }

    /// Each parameter with its value.
    pub fn iter(&self) -> impl Iterator<Item = &(Parameter, ParameterValue)> {
        self.0.iter()
    }

    /// The file, as [`Settings::from_file`] reads it.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let line = |(it, value): &(Parameter, ParameterValue)| {
            format!("{:<36} # {}", format!("{} = {}", it.name, spell(*value)), it.range())
        };
        self.0.iter().map(line).fold(String::new(), |text, line| text + &line + "\n")
    }

    /// SHA-256 in lower-case hexadecimal over all parameters in the order of their index, each as its name in UTF-8, a
    /// zero byte, the byte of its type on the wire (1 for a u32, 2 for an f32), and the four bytes of its value, little
    /// endian. Two drives with the same fingerprint have the same parameters in force, bit by bit.
    #[must_use]
    pub fn sha256(&self) -> String {
        let mut hash = Sha256::new();
        for (it, value) in &self.0 {
            hash.update(it.name.as_bytes());
            hash.update([0, value.ty() as u8]);
            hash.update(match value {
                ParameterValue::U32(value) => value.to_le_bytes(),
                ParameterValue::F32(value) => value.to_le_bytes(),
            });
        }
        hash.finalize().iter().fold(String::with_capacity(64), |mut hex, byte| {
            // Writing to a String can't fail.
            let _ = write!(hex, "{byte:02x}");
            hex
        })
    }
}

/// A value as TOML has it: a real number keeps its point, so that it is read as one.
#[must_use]
pub fn spell(value: ParameterValue) -> String {
    match value {
        ParameterValue::U32(value) => value.to_string(),
        ParameterValue::F32(value) => format!("{value:?}"),
    }
}

/// Why settings could not be read or not be brought to the drive. Each starts with the place to correct.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// The file can't be read.
    #[error("{}: can't be read: {source}", path.display())]
    Unreadable {
        /// Its path.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is no TOML.
    #[error("{}:{line}: {problem}", path.display())]
    Syntax {
        /// Its path.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What TOML says to it.
        problem: String,
    },
    /// A word or a line that is no setting.
    #[error("{place}: {found}; it must be {wanted}")]
    Malformed {
        /// Where it was written.
        place: String,
        /// What was written.
        found: String,
        /// What may stand there.
        wanted: &'static str,
    },
    /// A name that is set twice.
    #[error("{place}: {name} is set already, by {before}")]
    Twice {
        /// Where it was written.
        place: String,
        /// The name.
        name: String,
        /// Where it was written before.
        before: String,
    },
    /// The drive has no such parameter or does not take the value. Nothing has been set.
    #[error("{place}: {name} = {number}: {source}; nothing has been set")]
    Unfit {
        /// Where it was written.
        place: String,
        /// The parameter.
        name: String,
        /// The number.
        number: f64,
        /// What is wrong with it.
        source: Box<SetError>,
    },
    /// The drive refused a value that is within the range it gave.
    #[error("{place}: {name} = {number}: {source}; {done} parameters before it have been set")]
    Refused {
        /// Where it was written.
        place: String,
        /// The parameter.
        name: String,
        /// The number.
        number: f64,
        /// Parameters set before it.
        done: usize,
        /// What it said.
        source: Box<SetError>,
    },
    /// The conversation broke.
    #[error(transparent)]
    Session(SessionError),
}

/// Parameters somebody wants set, in the order in which they were written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings(Vec<Setting>);

#[derive(Debug, Clone, PartialEq)]
struct Setting {
    place: String,
    name: String,
    number: f64,
}

impl Settings {
    /// Reads a file as [`ParameterSet::to_toml`] writes it. It need not hold every parameter.
    ///
    /// # Errors
    /// It can't be read, is no TOML, or holds something else than numbers.
    pub fn from_file(path: &Path) -> Result<Self, SettingsError> {
        let text = fs::read_to_string(path)
            .map_err(|source| SettingsError::Unreadable { path: path.to_owned(), source })?;
        let line_of = |offset: usize| 1 + text[..offset.min(text.len())].matches('\n').count();
        let document = Document::parse(text.as_str()).map_err(|error| SettingsError::Syntax {
            path: path.to_owned(),
            line: line_of(error.span().map_or(0, |span| span.start)),
            problem: error.message().replace('\n', "; "),
        })?;
        let mut settings = Self::default();
        for (name, item) in document.iter() {
            let place = format!("{}:{}", path.display(), line_of(item.span().map_or(0, |span| span.start)));
            let number = match item {
                Item::Value(Value::Integer(value)) => *value.value() as f64,
                Item::Value(Value::Float(value)) => *value.value(),
                _ => {
                    let found = format!("{name} is no setting");
                    return Err(SettingsError::Malformed { place, found, wanted: "NAME = NUMBER" });
                }
            };
            settings.push(place, name, number)?;
        }
        Ok(settings)
    }

    /// Reads words as the command line has them, each `NAME=VALUE`.
    ///
    /// # Errors
    /// One of them is no such word, or a name comes twice.
    pub fn from_words(words: &[String]) -> Result<Self, SettingsError> {
        let mut settings = Self::default();
        for word in words {
            let malformed = || SettingsError::Malformed {
                place: format!("set {word}"),
                found: "no setting".to_owned(),
                wanted: "NAME=NUMBER",
            };
            let (name, number) = word.split_once('=').ok_or_else(malformed)?;
            let number = number.trim().parse().map_err(|_| malformed())?;
            settings.push(format!("set {word}"), name.trim(), number)?;
        }
        Ok(settings)
    }

    /// Brings all of them to the drive and checks each by what is read back. Names and ranges are looked at before the
    /// first one is set. Returns what is in force now.
    ///
    /// # Errors
    /// The drive has no such parameter, does not take a value, or the conversation broke.
    pub fn apply(&self, session: &mut Session) -> Result<ParameterSet, SettingsError> {
        for Setting { place, name, number } in &self.0 {
            session.fits(name, *number).map_err(|source| SettingsError::Unfit {
                place: place.clone(),
                name: name.clone(),
                number: *number,
                source: Box::new(source),
            })?;
        }
        for (done, Setting { place, name, number }) in self.0.iter().enumerate() {
            session.set(name, *number).map_err(|error| match error {
                SetError::Session(source) => SettingsError::Session(source),
                source => SettingsError::Refused {
                    place: place.clone(),
                    name: name.clone(),
                    number: *number,
                    done,
                    source: Box::new(source),
                },
            })?;
        }
        ParameterSet::read(session).map_err(SettingsError::Session)
    }

    /// Whether a parameter of this name is among them.
    #[must_use]
    pub fn contains(&self, name: &str) -> bool {
        self.0.iter().any(|setting| setting.name == name)
    }

    fn push(&mut self, place: String, name: &str, number: f64) -> Result<(), SettingsError> {
        if let Some(before) = self.0.iter().find(|setting| setting.name == name) {
            let before = before.place.clone();
            return Err(SettingsError::Twice { place, name: name.to_owned(), before });
        }
        self.0.push(Setting { place, name: name.to_owned(), number });
        Ok(())
    }
}
