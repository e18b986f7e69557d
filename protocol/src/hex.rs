//! Bytes as hexadecimal digits, for error messages, records and tests.

use core::fmt;

/// Displays bytes as lower-case digits: `{}` without separators (`0a1b`), `{:#}` separated by spaces (`0a 1b`).
#[derive(Clone, Copy, Debug)]
pub struct Hex<'a>(pub &'a [u8]);

impl fmt::Display for Hex<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, byte) in self.0.iter().enumerate() {
            let separator = if out.alternate() && at > 0 { " " } else { "" };
            write!(out, "{separator}{byte:02x}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::format;

    use super::*;

    #[test]
    fn the_alternate_form_separates_bytes_by_spaces() {
        assert_eq!(format!("{}", Hex(&[0x0a, 0xff])), "0aff");
        assert_eq!(format!("{:#}", Hex(&[0x0a, 0xff])), "0a ff");
        assert_eq!(format!("{}", Hex(&[])), "");
    }
}
