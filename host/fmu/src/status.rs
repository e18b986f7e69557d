//! Statuses of an FMU's functions, and its messages.

use std::ffi::c_int;
use std::io::{self, Write as _};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::FmuError;
use crate::variable::Variable;

/// Most characters of the messages of a call. The first message mostly has the cause.
const LONGEST: usize = 500;

/// The FMU's messages during the current call, for errors. A static, because FMI 2.0 calls back with an environment of the FMU's
/// choice.
static MESSAGES: Mutex<String> = Mutex::new(String::new());

/// Whether a function of this name has passed.
pub(crate) fn passed(function: &str, status: c_int) -> Result<(), FmuError> {
    match status {
        0 | 1 => Ok(()),
        _ => {
            Err(FmuError::Call { function: function.to_owned(), status: status_name(status), log: logged() })
        }
    }
}

/// Whether a function of this name has read or set a variable; `action` says which.
pub(crate) fn accessed(
    action: &'static str,
    variable: &Variable,
    time_s: f64,
    function: &str,
    status: c_int,
) -> Result<(), FmuError> {
    match status {
        0 | 1 => Ok(()),
        _ => Err(FmuError::Access {
            action,
            name: variable.name.clone(),
            time_s,
            function: function.to_owned(),
            status: status_name(status),
            log: logged(),
        }),
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

fn messages() -> MutexGuard<'static, String> {
    MESSAGES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Forgets the messages: the next ones are of another call.
pub(crate) fn clear() {
    messages().clear();
}

/// `: TEXT` of the messages of the current call, if there are any.
pub(crate) fn logged() -> String {
    let messages = messages();
    if messages.is_empty() { String::new() } else { format!(": {messages}") }
}

/// Takes a message of the FMU.
pub(crate) fn log(message: &str) {
    // A panic must not reach the FMU, and `eprintln!` panics if nobody reads.
    let _ = writeln!(io::stderr(), "{message}");
    let mut messages = messages();
    if !messages.is_empty() {
        messages.push_str("; ");
    }
    messages.push_str(message.trim_end());
    if let Some((end, _)) = messages.char_indices().nth(LONGEST) {
        messages.truncate(end);
        messages.push_str("...");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_has_the_messages_of_its_call_up_to_a_length() {
        log("the belt is old");
        clear();
        log("the belt slips\n");
        log("it smells");
        assert_eq!(logged(), ": the belt slips; it smells");
        for _ in 0..2 {
            log(&"\u{e9}".repeat(LONGEST));
            let have = logged();
            assert!(
                have.starts_with(": the belt slips; it smells; \u{e9}") && have.ends_with("\u{e9}..."),
                "{have}"
            );
            assert_eq!(have.chars().count(), 2 + LONGEST + 3);
        }
        clear();
        assert_eq!(logged(), "");
    }
}
