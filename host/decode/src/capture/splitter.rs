//! Splits a stream at its delimiters.

use lashloop_protocol::frame::DELIMITER;

/// Longest piece. A stream without delimiters is split here, so that memory stays bounded.
pub(super) const LONGEST: usize = 4096;

/// Collects the bytes since the last delimiter. A damaged frame is a piece like any other. Allocates only on creation.
#[derive(Debug)]
pub struct Splitter {
    pending: Vec<u8>,
}

impl Default for Splitter {
    fn default() -> Self {
        Self { pending: Vec::with_capacity(LONGEST) }
    }
}

impl Splitter {
    /// Passes every piece that `bytes` completes to `take`, the delimiter included.
    pub fn push(&mut self, bytes: &[u8], mut take: impl FnMut(&[u8])) {
        for piece in bytes.split_inclusive(|&byte| byte == DELIMITER) {
            let complete = piece.last() == Some(&DELIMITER);
            if complete && self.pending.is_empty() {
                take(piece);
                continue;
            }
            for part in piece.chunks(LONGEST) {
                if self.pending.len() + part.len() > LONGEST {
                    take(&self.pending);
                    self.pending.clear();
                }
                self.pending.extend_from_slice(part);
            }
            if complete {
                take(&self.pending);
                self.pending.clear();
            }
        }
    }

    /// Passes the bytes after the last delimiter to `take` and empties the splitter.
    pub fn finish(&mut self, take: impl FnOnce(&[u8])) {
        if !self.pending.is_empty() {
            take(&self.pending);
            self.pending.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(chunks: &[&[u8]]) -> Vec<Vec<u8>> {
        let (mut splitter, mut pieces) = (Splitter::default(), Vec::new());
        for chunk in chunks {
            splitter.push(chunk, |piece| pieces.push(piece.to_vec()));
        }
        splitter.finish(|piece| pieces.push(piece.to_vec()));
        pieces
    }

    #[test]
    fn pieces_do_not_depend_on_how_the_bytes_arrived() {
        let whole: &[u8] = &[0, 3, 7, 9, 0, 0, 5, 5, 5];
        let expected = [vec![0], vec![3, 7, 9, 0], vec![0], vec![5, 5, 5]];
        assert_eq!(pieces(&[whole]), expected);
        assert_eq!(pieces(&whole.chunks(1).collect::<Vec<_>>()), expected);
        assert_eq!(pieces(&whole.chunks(4).collect::<Vec<_>>()), expected);
    }

    #[test]
    fn a_line_without_a_delimiter_is_cut_and_loses_nothing() {
        let noise = [7; 3 * LONGEST / 2];
        let pieces = pieces(&noise.chunks(100).collect::<Vec<_>>());
        assert!(pieces.len() > 1 && pieces.iter().all(|piece| piece.len() <= LONGEST));
        assert_eq!(pieces.concat(), noise);
    }
}
