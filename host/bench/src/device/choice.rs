//! Parsing and display of `--device`.

use std::fmt;
use std::ops::Deref;
use std::str::FromStr;
use std::sync::Arc;

use lashloop_firmware::Laws;

use super::error::DeviceError;
use super::kind::{DeviceKind, Syntax};
use super::kinds;
use super::pin_plant::PinPlant;
use crate::scenario::{Scenario, nearest};
use crate::timing::ClockName;

/// The drive of a session: parsed from the text after `--device`, and displayed as that text.
#[derive(Debug, Clone)]
pub struct DeviceChoice(Arc<dyn DeviceKind>);

impl<K: DeviceKind + 'static> From<K> for DeviceChoice {
    fn from(kind: K) -> Self {
        Self(Arc::new(kind))
    }
}

impl Deref for DeviceChoice {
    type Target = dyn DeviceKind;

    fn deref(&self) -> &Self::Target {
        self.0.as_ref()
    }
}

impl DeviceChoice {
    /// Parses a name of one of these kinds, tried in their order.
    ///
    /// # Errors
    /// What is missing in the name, or all forms there are.
    pub fn parse(text: &str, kinds: &[Syntax]) -> Result<Self, String> {
        let kind = kinds.iter().find_map(|syntax| (syntax.parse)(text));
        let unknown = || Err(format!("expected {}{}", forms(kinds), suggestion(text, kinds)));
        kind.unwrap_or_else(unknown).map(|kind| Self(kind.into()))
    }

    /// This device for a run: in bench mode with the scenario's plant behind the pins, unless they are wired to hardware.
    ///
    /// # Errors
    /// The plant can't be put behind the pins, and what to do.
    pub fn for_run(&self, scenario: &Scenario, clock: ClockName) -> Result<Self, DeviceError> {
        if scenario.run.mode.is_hil() {
            return Ok(self.clone());
        }
        let with_plant = self.with_plant(&PinPlant { scenario: scenario.clone(), clock })?;
        Ok(with_plant.map_or_else(|| self.clone(), |kind| Self(kind.into())))
    }

    /// Whether each session has a drive of its own, so that several can run at once.
    #[must_use]
    pub fn has_drive_per_session(&self) -> bool {
        !self.may_be_hardware()
    }
}

impl FromStr for DeviceChoice {
    type Err = String;

    /// Parses a name. The drive in this process has Lashloop's laws.
    fn from_str(text: &str) -> Result<Self, String> {
        Self::parse(text, &kinds::all::<Laws>())
    }
}

/// What to write for a device of these kinds, as a list.
#[must_use]
pub fn forms(kinds: &[Syntax]) -> String {
    let forms: Vec<_> = kinds.iter().map(|syntax| syntax.form).collect();
    let (last, others) = forms.split_last().expect("there are kinds");
    format!("{} or {last}", others.join(", "))
}

/// The device that was probably meant: a terminal without its folder, or a kind in other letters.
fn suggestion(text: &str, kinds: &[Syntax]) -> String {
    if text.starts_with("tty") {
        return format!(" (did you mean /dev/{text}?)");
    }
    let words = kinds.iter().map(|it| it.form).filter(|form| form.bytes().all(|it| it.is_ascii_lowercase()));
    nearest(text, words).map_or_else(String::new, |word| format!(" (did you mean {word}?)"))
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_displayed_as_it_is_named() {
        for name in [
            "inproc",
            "native",
            "qemu",
            "qemu:a.elf",
            "silicon",
            "silicon:a.elf",
            "exec:./drive --name 'a b' {tty}",
            "tcp:localhost:4000",
            "tcp:[::1]:4000",
            "rfc2217:192.0.2.1:2217",
            "/dev/ttyACM0",
        ] {
            let choice: DeviceChoice = name.parse().expect("a device");
            assert_eq!(choice.to_string(), name);
        }
    }

    #[test]
    fn an_unknown_name_is_refused_with_those_that_are_known() {
        let known = "inproc, native, qemu, qemu:ELF, silicon, silicon:ELF, exec:CMD ARGS, tcp:HOST:PORT, \
                     rfc2217:HOST:PORT or the path of a terminal like /dev/ttyACM0";
        assert_eq!("board".parse::<DeviceChoice>().map(drop), Err(format!("expected {known}")));
        let incomplete = "qemu:".parse::<DeviceChoice>().map(drop);
        assert_eq!(incomplete, Err("qemu: needs the path of an image after the colon".to_owned()));
        for (name, problem) in [
            ("silicon:", "silicon: needs the path of an image after the colon"),
            ("tcp:here", "tcp: "),
            ("rfc2217:a:0", "rfc2217: "),
            ("exec:", "exec: needs a command after the colon"),
        ] {
            let error = name.parse::<DeviceChoice>().map(drop).unwrap_err();
            assert!(error.contains(problem), "{name}: {error}");
        }
    }
}
