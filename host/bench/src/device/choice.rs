//! Parsing and display of `--device`.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use super::kind::DeviceKind;
use super::kinds;

/// The drive of a session: parsed from the text after `--device`, and displayed as that text.
#[derive(Debug, Clone)]
pub struct DeviceChoice(pub(super) Arc<dyn DeviceKind>);

impl<K: DeviceKind + 'static> From<K> for DeviceChoice {
    fn from(kind: K) -> Self {
        Self(Arc::new(kind))
    }
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let kind = kinds::ALL.iter().find_map(|syntax| (syntax.parse)(text));
        kind.unwrap_or_else(|| Err(expected())).map(|kind| Self(kind.into()))
    }
}

fn expected() -> String {
    let forms: Vec<_> = kinds::ALL.iter().map(|syntax| syntax.form).collect();
    let (last, others) = forms.split_last().expect("there are kinds");
    format!("expected {} or {last}", others.join(", "))
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_displayed_as_it_is_named() {
        for name in ["inproc", "native", "qemu", "qemu:a.elf", "/dev/ttyACM0"] {
            let choice: DeviceChoice = name.parse().expect("a device");
            assert_eq!(choice.to_string(), name);
        }
    }

    #[test]
    fn an_unknown_name_is_refused_with_those_that_are_known() {
        let known = "inproc, native, qemu, qemu:ELF or the path of a terminal like /dev/ttyACM0";
        assert_eq!("board".parse::<DeviceChoice>().map(drop), Err(format!("expected {known}")));
        let incomplete = "qemu:".parse::<DeviceChoice>().map(drop);
        assert_eq!(incomplete, Err("qemu: needs the path of an image after the colon".to_owned()));
    }
}
