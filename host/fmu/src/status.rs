//! Statuses of an FMU's functions, and its messages.

use std::ffi::c_int;
use std::sync::{Mutex, PoisonError};

use crate::error::FmuError;

/// The FMU's last message, for errors. A static, because FMI 2.0 calls back with an environment of the FMU's choice.
static LAST_MESSAGE: Mutex<String> = Mutex::new(String::new());

/// Whether a function of this name has passed.
pub(crate) fn passed(function: &str, status: c_int) -> Result<(), FmuError> {
    match status {
        0 | 1 => Ok(()),
        _ => {
            Err(FmuError::Call { function: function.to_owned(), status: status_name(status), log: logged() })
        }
    }
}

/// A status that hasn't passed, in the words of FMI.
pub(crate) const fn status_name(status: c_int) -> &'static str {
    match status {
        2 => "\"discard\"",
        3 => "\"error\"",
        4 => "\"fatal\"",
        5 => "\"pending\", but lashloop-fmu waits for each step",
        _ => "a status that FMI lacks",
    }
}

/// `: TEXT` of the last message, if there is one.
pub(crate) fn logged() -> String {
    let message = LAST_MESSAGE.lock().unwrap_or_else(PoisonError::into_inner);
    if message.is_empty() { String::new() } else { format!(": {message}") }
}

/// Takes a message of the FMU.
pub(crate) fn log(message: &str) {
    eprintln!("{message}");
    message.clone_into(&mut LAST_MESSAGE.lock().unwrap_or_else(PoisonError::into_inner));
}
