//! The frames of the conversation in `docs/protocol/bytes.md`.

use crate::markdown::sheets;

/// Who sends a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Side {
    Host,
    Drive,
}

/// Sender and bytes of every frame of the document.
pub(crate) fn script() -> Vec<(Side, Vec<u8>)> {
    let frame = |sheet: &str| {
        let side = if sheet.contains("host -> drive") { Side::Host } else { Side::Drive };
        let (_, digits) = sheet.rsplit_once("frame: ").expect("a data sheet ends with its frame");
        let byte = |digits| u8::from_str_radix(digits, 16).expect("two hexadecimal digits");
        (side, digits.split_whitespace().map(byte).collect())
    };
    sheets().into_iter().map(frame).collect()
}
