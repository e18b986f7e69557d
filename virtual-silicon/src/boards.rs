//! The pin maps of boards: those of the folder `boards`, and files of a user.

use std::collections::BTreeMap;
use std::{fs, io};

use toml_edit::DocumentMut;

use crate::wiring::Wiring;

/// Names of the boards of the folder, with the texts of their files.
pub const BUILT_IN: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/boards.rs"));
/// Where the pin maps are in the working directory. A new one is found there before it is built in.
const FOLDER: &str = "virtual-silicon/boards";
/// The board of an image that names none.
pub const DEFAULT: &str = "stm32f405";

/// What is wrong with a board.
#[derive(Debug, thiserror::Error)]
#[error("{board}: {problem}")]
pub struct BoardError {
    /// The board or the file, as the user named it.
    pub board: String,
    /// What is wrong with it.
    pub problem: Problem,
}

/// What is wrong with a pin map.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The name isn't that of a board.
    #[error("no such board; there are {}, and a file of your own, whose name ends in .toml", names())]
    Unknown,
    /// The file can't be read.
    #[error("the file can't be read: {0}")]
    Unreadable(#[from] io::Error),
    /// The file isn't TOML.
    #[error("line {line}: {reason}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// What the reader expected there.
        reason: String,
    },
    /// A key is missing or unknown, or has a value that isn't allowed.
    #[error("{0}")]
    Key(String),
    /// A pin is of another kind than its use.
    #[error("{key} is {pin}, and has to be {kind}")]
    Mode {
        /// The key.
        key: &'static str,
        /// The pin with its configuration.
        pin: String,
        /// The kind that is allowed.
        kind: &'static str,
    },
    /// One pin or timer has two uses.
    #[error("{first} and {second} are both {what}; each needs its own")]
    Twice {
        /// The key of the first use.
        first: &'static str,
        /// The key of the second use.
        second: &'static str,
        /// The pin or the timer.
        what: String,
    },
}

fn names() -> String {
    BUILT_IN.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// The pin map of a board: the name of a built-in one or of a new one in [`FOLDER`], or the path of a file, which ends in `.toml`.
///
/// # Errors
/// The board is unknown, or its file is wrong.
pub fn open(board: &str) -> Result<Wiring, BoardError> {
    let wiring = match BUILT_IN.iter().find(|(name, _)| *name == board) {
        Some((_, text)) => read(text),
        None if board.ends_with(".toml") => {
            fs::read_to_string(board).map_err(Problem::from).and_then(|text| read(&text))
        }
        None => fs::read_to_string(format!("{FOLDER}/{board}.toml"))
            .map_err(|_| Problem::Unknown)
            .and_then(|text| read(&text)),
    };
    wiring.map_err(|problem| BoardError { board: board.to_owned(), problem })
}

/// Name of the image of a board, without the ending of its file.
#[must_use]
pub fn image_of(board: &str) -> String {
    if board == DEFAULT { "lashloop-firmware".into() } else { format!("lashloop-firmware-{board}") }
}

fn read(text: &str) -> Result<Wiring, Problem> {
    let document = text.parse::<DocumentMut>().map_err(|error| {
        let start = error.span().map_or(0, |span| span.start);
        Problem::Syntax { line: text[..start].matches('\n').count() + 1, reason: error.message().to_owned() }
    })?;
    // Without the text at hand, the error has the path of the key on its second line.
    let wiring: Wiring = toml_edit::de::from_document(document)
        .map_err(|error| Problem::Key(error.to_string().trim_end().replace('\n', ", ")))?;
    let mut keys = BTreeMap::new();
    for (key, pin, kind) in wiring.uses() {
        if pin.mode.kind() != kind {
            return Err(Problem::Mode { key, pin: pin.to_string(), kind });
        }
        if let Some(first) = keys.insert(pin.name(), key) {
            return Err(Problem::Twice { first, second: key, what: pin.name() });
        }
    }
    if wiring.motor.timer == wiring.load.timer {
        let what = format!("{:?}", wiring.load.timer).to_uppercase();
        return Err(Problem::Twice { first: "motor.timer", second: "load.timer", what });
    }
    Ok(wiring)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(from: &str, to: &str) -> String {
        let (_, text) = BUILT_IN.iter().find(|(name, _)| *name == "odrive-v3").expect("the board");
        assert!(text.contains(from), "{from}");
        read(&text.replace(from, to)).expect_err("a wrong file").to_string()
    }

    #[test]
    fn every_built_in_board_is_read() {
        for (name, _) in BUILT_IN {
            open(name).unwrap_or_else(|error| panic!("{error}"));
        }
        assert!(open(DEFAULT).is_ok() && BUILT_IN.len() >= 5);
    }

    #[test]
    fn a_wrong_pin_map_is_one_sentence() {
        let wrong_pin = "isn't a pin: write PA0 to PK15, then input, output, analog or AF0 to AF15, then pull-up, \
                         pull-down or nothing, in `load.a`";
        for (from, to, want) in [
            ("PB6 AF2", "PB16 AF2", &*format!("\"PB16 AF2 pull-up\" {wrong_pin}")),
            ("PB6 AF2", "PB6 AF16", &*format!("\"PB6 AF16 pull-up\" {wrong_pin}")),
            (
                "PB6 AF2",
                "PB6 input",
                "load.a is PB6 as an input with a pull-up, and has to be an alternate function",
            ),
            ("PB12 output", "PB4 output", "motor.a and bridge.enable are both PB4; each needs its own"),
            ("TIM4", "TIM3", "motor.timer and load.timer are both TIM3; each needs its own"),
            (
                "TIM4",
                "TIM6",
                "unknown variant `TIM6`, expected one of `TIM2`, `TIM3`, `TIM4`, `TIM5`, in `load.timer`",
            ),
            (
                "USART2",
                "USART9",
                "unknown variant `USART9`, expected one of `USART1`, `USART2`, `USART3`, `UART4`, `UART5`, `USART6`, `UART7`, `UART8`, in `link.port`",
            ),
            ("stm32f4", "stm32g4", "unknown variant `stm32g4`, expected `stm32f4` or `stm32h7`, in `chip`"),
            (
                "enable",
                "able",
                "unknown field `able`, expected one of `outputs`, `complements`, `break_input`, `enable`, `current`, `bus`, `brake`, `unused_gates`, in `bridge`",
            ),
            ("enable =", "#", "missing field `enable`, in `bridge`"),
            (", \"PA9 AF1\"]", "]", "invalid length 1, expected an array of length 2, in `bridge.outputs`"),
            ("[link]", "[link", "line 7: unclosed table, expected `]`"),
        ] {
            assert_eq!(problem(from, to), want, "{to}");
        }
    }

    #[test]
    fn a_board_is_a_name_or_a_file() {
        // As the program prints it, with causes.
        let message = |board| format!("{:#}", anyhow::Error::from(open(board).expect_err("no such board")));
        let unknown = message("arduino");
        assert!(unknown.starts_with("arduino: no such board; there are nucleo-f429zi, "), "{unknown}");
        assert_eq!(unknown.matches("no such board").count(), 1, "{unknown}");
        let absent = message("/absent.toml");
        assert!(absent.starts_with("/absent.toml: the file can't be read: "), "{absent}");
    }
}
