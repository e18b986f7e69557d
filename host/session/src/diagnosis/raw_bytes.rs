//! Statistics of the bytes outside good frames.

use crate::text::printable;

/// First bytes that are kept.
const KEPT: usize = 160;
/// Characters of a text that are shown.
const SHOWN: usize = 60;

/// Statistics of the bytes outside good frames, lone delimiters excluded.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RawBytes {
    /// Bytes.
    pub count: u64,
    /// Characters of ASCII text among them, line ends included.
    pub text: u64,
    /// Changes between neighbouring bits within all bytes: 3.5 a byte for random data, at most 2 a byte for a UART that
    /// samples several times faster than the far end sends.
    pub transitions: u64,
    /// The first bytes.
    head: heapless::Vec<u8, KEPT>,
    /// The first bytes with their delimiters.
    framed: heapless::Vec<u8, KEPT>,
}

impl RawBytes {
    pub(super) fn add(&mut self, bytes: &[u8]) {
        self.count += bytes.len() as u64;
        for byte in bytes {
            self.text += u64::from(is_text(*byte));
            self.transitions += u64::from(((byte ^ (byte >> 1)) & 0x7f).count_ones());
        }
        keep(bytes, &mut self.head);
        keep(bytes, &mut self.framed);
    }

    /// Delimiters arrived, behind bytes or alone.
    pub(super) fn add_delimiters(&mut self, count: usize) {
        keep(&[0; KEPT][..count.min(KEPT)], &mut self.framed);
    }

    /// The first bytes.
    #[must_use]
    pub fn head(&self) -> &[u8] {
        &self.head
    }

    /// Delimiters alone explain nothing.
    pub(super) fn forget_delimiters(&mut self) {
        self.framed.clear();
    }

    /// The first bytes with their delimiters.
    pub(super) fn framed(&self) -> &[u8] {
        &self.framed
    }

    /// Whether a person could read them.
    #[must_use]
    pub fn is_text(&self) -> bool {
        self.count >= 4 && self.is_varied() && 10 * self.text >= 9 * self.count
    }

    /// Whether they are more than one byte over and over.
    fn is_varied(&self) -> bool {
        self.head().iter().any(|byte| *byte != self.head[0])
    }

    /// The first line with letters in it, escaped and shortened.
    #[must_use]
    pub fn first_line(&self) -> String {
        let text = String::from_utf8_lossy(self.head());
        let lines = text.split(['\r', '\n']).map(str::trim);
        let line = lines.clone().find(|line| line.chars().any(char::is_alphanumeric)).unwrap_or_default();
        let shown: String = line.chars().take(SHOWN).collect();
        let cut = if shown.len() < line.len() { "..." } else { "" };
        format!("{}{cut}", printable(&shown))
    }

    /// Whether they are what a terminal in cooked mode makes of frames: `^@` for a delimiter, `^A` for the byte 1.
    #[must_use]
    pub fn is_cooked_echo(&self) -> bool {
        let pairs = |wanted: &[u8; 2]| self.head().windows(2).filter(|pair| pair == wanted).count();
        // A byte of the checksum may be a signal character, on which the terminal drops the beginning of the echo.
        pairs(b"^@") >= 2 || (pairs(b"^@") == 1 && pairs(b"^A") >= 1)
    }

    /// Whether a UART received them that samples faster than the far end sends.
    #[must_use]
    pub fn is_sampled_too_fast(&self) -> bool {
        // One byte over and over is padding.
        self.count >= 16 && self.is_varied() && self.transitions <= 2 * self.count
    }
}

/// Keeps as many of `bytes` as `kept` still takes.
fn keep(bytes: &[u8], kept: &mut heapless::Vec<u8, KEPT>) {
    kept.extend(bytes.iter().take(KEPT - kept.len()).copied());
}

fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~' | b'\r' | b'\n' | b'\t' | 0x1b)
}
