//! Statistics of the bytes outside good frames.

use crate::text::printable;

/// First bytes that are kept.
const KEPT: usize = 160;
/// Characters of a text that are shown.
const SHOWN: usize = 60;

/// Statistics of the bytes outside good frames, lone delimiters excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawBytes {
    /// Bytes.
    pub count: u64,
    /// Characters of ASCII text among them, line ends included.
    pub text: u64,
    /// Changes between neighbouring bits within all bytes: 3.5 a byte for random data, at most 2 a byte for a UART that
    /// samples several times faster than the far end sends.
    pub transitions: u64,
    head: [u8; KEPT],
    head_len: usize,
}

impl Default for RawBytes {
    fn default() -> Self {
        Self { count: 0, text: 0, transitions: 0, head: [0; KEPT], head_len: 0 }
    }
}

impl RawBytes {
    pub(super) fn add(&mut self, bytes: &[u8]) {
        self.count += bytes.len() as u64;
        for byte in bytes {
            self.text += u64::from(is_text(*byte));
            self.transitions += u64::from(((byte ^ (byte >> 1)) & 0x7f).count_ones());
        }
        let free = &mut self.head[self.head_len..];
        let kept = bytes.len().min(free.len());
        free[..kept].copy_from_slice(&bytes[..kept]);
        self.head_len += kept;
    }

    /// The first bytes.
    #[must_use]
    pub fn head(&self) -> &[u8] {
        &self.head[..self.head_len]
    }

    /// Whether a person could read them.
    #[must_use]
    pub fn is_text(&self) -> bool {
        let is_varied = self.head().iter().any(|byte| *byte != self.head[0]);
        self.count >= 4 && is_varied && 10 * self.text >= 9 * self.count
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
        self.count >= 16 && self.transitions <= 2 * self.count
    }
}

fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~' | b'\r' | b'\n' | b'\t' | 0x1b)
}
