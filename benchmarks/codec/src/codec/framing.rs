//! Framing for the codecs that have none: CRC-32C, or no check, and the `cobs` crate.

use super::CRC_32;

pub struct Framing<const CRC: bool> {
    plain: [u8; 64],
    stuffed: [u8; 64],
}

impl<const CRC: bool> Default for Framing<CRC> {
    fn default() -> Self {
        Self { plain: [0; 64], stuffed: [0; 64] }
    }
}

impl<const CRC: bool> Framing<CRC> {
    /// Passes the frame of a body to `send`. `write` puts the body into its buffer and returns the length.
    #[inline(always)]
    pub fn send(&mut self, write: impl FnOnce(&mut [u8]) -> usize, send: impl FnOnce(&[u8])) {
        let mut len = write(&mut self.plain);
        if CRC {
            let crc = CRC_32.checksum(&self.plain[..len]);
            self.plain[len..len + 4].copy_from_slice(&crc.to_le_bytes());
            len += 4;
        }
        let end = cobs::encode(&self.plain[..len], &mut self.stuffed);
        self.stuffed[end] = 0;
        send(&self.stuffed[..=end]);
    }

    /// The body of a correct frame.
    #[inline(always)]
    pub fn open(&mut self, frame: &[u8]) -> &[u8] {
        let end = cobs::decode(&frame[..frame.len() - 1], &mut self.plain).expect("stuffed").frame_size();
        if !CRC {
            return &self.plain[..end];
        }
        let (body, crc) = self.plain[..end].split_last_chunk().expect("a CRC");
        assert_eq!(CRC_32.checksum(body), u32::from_le_bytes(*crc));
        body
    }
}
