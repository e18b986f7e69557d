//! The parameters of a drive as a file and as a fingerprint.
//!
//! The file is TOML, with a line per parameter in the order of the index, and unit and range as comments. Real numbers have
//! enough digits to restore the same bits, and choices are written by name.

use std::fmt;
use std::path::{Path, PathBuf};

use lashloop_protocol::enums::ParameterValue;
use toml_edit::{Document, Item, Key, Value};

use lashloop_bench::regular_file;
use lashloop_bench::run::digest;
use lashloop_session::{Parameter, Session, SessionError, SetError, WrittenValue};

/// All parameters of a drive with their values, in the order of the index.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSet(Vec<(Parameter, ParameterValue)>);

impl ParameterSet {
    /// Reads every value from the drive.
    ///
    /// # Errors
    /// The session fails.
    pub fn read(session: &mut Session) -> Result<Self, SessionError> {
        let parameters = session.parameters.to_vec();
        let valued = parameters.into_iter().map(|it| session.get(it.index).map(|value| (it, value)));
        valued.collect::<Result<_, _>>().map(Self)
    }

    pub fn iter(&self) -> impl Iterator<Item = &(Parameter, ParameterValue)> {
        self.0.iter()
    }

    /// The file format of [`Settings::from_file`].
    #[must_use]
    pub fn to_toml(&self) -> String {
        let line = |(it, value): &(Parameter, ParameterValue)| {
            // A value of a type that no TOML has can't be restored.
            let start = if matches!(value, ParameterValue::Unknown { .. }) { "# " } else { "" };
            let setting = format!("{start}{} = {}", Key::new(&*it.name), to_toml_value(it, *value));
            format!("{setting:<36} # {}", it.range())
        };
        self.0.iter().map(line).fold(String::new(), |text, line| text + &line + "\n")
    }

    /// SHA-256 in lower-case hexadecimal over all parameters in the order of the index. Each contributes its name in UTF-8, a
    /// zero byte, its type on the wire (1 for u32, 2 for f32), and the four bytes of its value, little endian. Equal
    /// fingerprints mean equal parameters, bit for bit.
    #[must_use]
    pub fn sha256(&self) -> String {
        let mut bytes = Vec::new();
        for (it, value) in &self.0 {
            bytes.extend_from_slice(it.name.as_bytes());
            bytes.extend_from_slice(&[0, value.ty().byte()]);
            bytes.extend_from_slice(&match value {
                ParameterValue::U32(value) => value.to_le_bytes(),
                ParameterValue::F32(value) => value.to_le_bytes(),
                ParameterValue::Unknown { bytes, .. } => *bytes,
            });
        }
        digest::sha256(&bytes)
    }
}

/// A value of a parameter in TOML: the name of a choice in quotes, a real number with its decimal point, so that it is read
/// back as one.
#[must_use]
pub fn to_toml_value(parameter: &Parameter, value: ParameterValue) -> String {
    match (parameter.choice(value), value) {
        (Some(choice), _) => Value::from(choice).to_string(),
        (None, ParameterValue::U32(value)) => value.to_string(),
        (None, ParameterValue::F32(value)) if value.is_nan() => "nan".to_owned(),
        (None, ParameterValue::F32(value)) => format!("{value:?}"),
        (None, unknown @ ParameterValue::Unknown { .. }) => format!("{unknown} ({})", unknown.ty()),
    }
}

/// A value as a list shows it: as in TOML, without the quotes.
#[must_use]
pub fn to_plain_value(parameter: &Parameter, value: ParameterValue) -> String {
    match parameter.choice(value) {
        Some(choice) => choice.to_owned(),
        None => to_toml_value(parameter, value),
    }
}

/// Why settings can't be read or applied. Each message starts with the place to correct.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    #[error("{}: can't be read: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{}:{line}: {problem}", path.display())]
    Syntax {
        path: PathBuf,
        /// From 1.
        line: usize,
        problem: String,
    },
    #[error("{place}: {found}; it must be {wanted}")]
    Malformed { place: String, found: String, wanted: &'static str },
    #[error("{place}: {name} is set already, by {before}")]
    Twice { place: String, name: String, before: String },
    /// The drive lacks the parameter, or the value is out of its range. Detected before any parameter is set.
    #[error("{setting}: {source}; nothing has been set")]
    Unfit { setting: Setting, source: Box<SetError> },
    /// The drive refused a value within its own range.
    #[error("{setting}: {source}; {done} parameters before it have been set")]
    Refused { setting: Setting, done: usize, source: Box<SetError> },
    #[error(transparent)]
    Session(SessionError),
}

/// Parameters to set, in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings(Vec<Setting>);

#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    place: String,
    name: String,
    value: SettingValue,
}

/// A value as it is written.
#[derive(Debug, Clone, PartialEq)]
enum SettingValue {
    Number(f64),
    /// The name of a choice.
    Name(String),
}

impl SettingValue {
    fn written(&self) -> WrittenValue<'_> {
        match self {
            Self::Number(number) => WrittenValue::Number(*number),
            Self::Name(name) => WrittenValue::Name(name),
        }
    }
}

impl fmt::Display for SettingValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(out, "{number}"),
            Self::Name(name) => out.write_str(name),
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}: {} = {}", self.place, self.name, self.value)
    }
}

impl Settings {
    /// Reads a file of [`ParameterSet::to_toml`], which may hold a part of the parameters.
    ///
    /// # Errors
    /// The file can't be read, is not TOML, or holds values other than numbers and texts.
    pub fn from_file(path: &Path) -> Result<Self, SettingsError> {
        let text = regular_file::read_text(path)
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
            let value = match item {
                Item::Value(Value::Integer(value)) => SettingValue::Number(*value.value() as f64),
                Item::Value(Value::Float(value)) => SettingValue::Number(*value.value()),
                Item::Value(Value::String(value)) => SettingValue::Name(value.value().clone()),
                _ => {
                    let found = format!("{name} isn't a setting");
                    return Err(SettingsError::Malformed {
                        place,
                        found,
                        wanted: "NAME = NUMBER or NAME = \"CHOICE\"",
                    });
                }
            };
            settings.push(place, name, value)?;
        }
        Ok(settings)
    }

    /// Parses arguments of the form `NAME=VALUE`.
    ///
    /// # Errors
    /// An argument has another form, or repeats a name.
    pub fn from_words(words: &[String]) -> Result<Self, SettingsError> {
        let mut settings = Self::default();
        for word in words {
            let malformed = || SettingsError::Malformed {
                place: format!("set {word}"),
                found: "no setting".to_owned(),
                wanted: "NAME=NUMBER or NAME=CHOICE",
            };
            let (name, value) = word.split_once('=').ok_or_else(malformed)?;
            let value = match (value.trim(), value.trim().parse()) {
                ("", _) => return Err(malformed()),
                (_, Ok(number)) => SettingValue::Number(number),
                (text, Err(_)) => SettingValue::Name(text.to_owned()),
            };
            settings.push(format!("set {word}"), name.trim(), value)?;
        }
        Ok(settings)
    }

    /// Sets all parameters and verifies each by reading it back. Names and ranges are checked before the first one is set.
    /// Returns all parameters of the drive.
    ///
    /// # Errors
    /// The drive lacks a parameter or refuses a value, or the session fails.
    pub fn apply(&self, session: &mut Session) -> Result<ParameterSet, SettingsError> {
        for setting in &self.0 {
            let unfit = |source| SettingsError::Unfit { setting: setting.clone(), source: Box::new(source) };
            session.fits(&setting.name, setting.value.written()).map_err(unfit)?;
        }
        for (done, setting) in self.0.iter().enumerate() {
            session.set(&setting.name, setting.value.written()).map_err(|error| match error {
                SetError::Session(source) => SettingsError::Session(source),
                source => SettingsError::Refused { setting: setting.clone(), done, source: Box::new(source) },
            })?;
        }
        ParameterSet::read(session).map_err(SettingsError::Session)
    }

    #[must_use]
    pub fn contains(&self, name: &str) -> bool {
        self.0.iter().any(|setting| setting.name == name)
    }

    fn push(&mut self, place: String, name: &str, value: SettingValue) -> Result<(), SettingsError> {
        if let Some(before) = self.0.iter().find(|setting| setting.name == name) {
            let before = before.place.clone();
            return Err(SettingsError::Twice { place, name: name.to_owned(), before });
        }
        self.0.push(Setting { place, name: name.to_owned(), value });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use lashloop_session::LawMask;

    use std::fs;

    use super::*;

    fn parameter(name: &str) -> Parameter {
        let [default, min, max] = [0.0, -1.0, 1.0].map(ParameterValue::F32);
        Parameter {
            index: 0,
            name: name.to_owned(),
            unit: String::new(),
            default,
            min,
            max,
            live: false,
            laws: LawMask(1),
            choices: Vec::new(),
        }
    }

    #[test]
    fn every_name_and_every_number_is_restored() {
        let values = [("k_p1", 0.1), ("Kp [N m]", f32::INFINITY), ("axis.1", f32::NAN), ("", -0.0)];
        let set = values.map(|(name, value)| (parameter(name), ParameterValue::F32(value)));
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("parameters.toml");
        fs::write(&path, ParameterSet(set.to_vec()).to_toml()).expect("a file");
        let read = Settings::from_file(&path).expect("settings").0;
        assert_eq!(read.len(), values.len());
        for (setting, (name, value)) in read.iter().zip(values) {
            let SettingValue::Number(number) = setting.value else { panic!("{setting}") };
            assert_eq!(setting.name, name);
            assert!(
                (number as f32).to_bits() == value.to_bits() || number.is_nan() && value.is_nan(),
                "{setting}"
            );
        }
    }
}
