//! Consistent overhead byte stuffing (Cheshire and Baker 1999) for frames that fit into one block.
//!
//! A frame is shorter than the 254 bytes after which COBS starts a new block. One code byte in front is therefore the whole
//! overhead, and both directions work in place in a single pass: the zeros of the body become a chain of distances. We do not
//! use the `cobs` crate, which needs a second buffer; the tests compare with it.

/// Stuffs `frame[1..]` in place: `frame[0]` and every zero become the distance to the next zero or to the end.
///
/// `frame` is at most 254 bytes long, which [`MAX_FRAME`](crate::limits::MAX_FRAME) ensures.
#[inline]
pub fn stuff(frame: &mut [u8]) {
    let mut code_at = 0;
    for at in 1..frame.len() {
        // No branch on the byte, because the position of zeros is unpredictable.
        frame[code_at] = (at - code_at) as u8;
        code_at = if frame[at] == 0 { at } else { code_at };
    }
    frame[code_at] = (frame.len() - code_at) as u8;
}

/// Index of the first zero in `bytes`.
///
/// Word by word: the lowest byte of `(x - 1) & !x` with its highest bit set is the first zero byte of `x`.
#[inline]
pub(crate) fn find_zero(bytes: &[u8]) -> Option<usize> {
    const WORD: usize = size_of::<usize>();
    const ONES: usize = usize::from_ne_bytes([1; WORD]);
    const HIGHS: usize = ONES << 7;
    let zero_in = |word: &[u8; WORD]| {
        let word = usize::from_le_bytes(*word);
        let zeros = word.wrapping_sub(ONES) & !word & HIGHS;
        (zeros != 0).then_some(zeros.trailing_zeros() as usize / 8)
    };
    let Some(last) = bytes.last_chunk() else { return bytes.iter().position(|&byte| byte == 0) };
    for (at, word) in bytes.as_chunks().0.iter().enumerate() {
        if let Some(zero) = zero_in(word) {
            return Some(WORD * at + zero);
        }
    }
    // The last word overlaps the word before it, which holds no zero.
    zero_in(last).map(|zero| bytes.len() - WORD + zero)
}

/// Removes the stuffing of `frame` in place and returns the bytes after the code byte; `None` if the chain of distances does
/// not end at the end of the frame.
///
/// `frame` holds the bytes between two delimiters. A zero byte in the chain is rejected.
#[inline]
pub fn unstuff(frame: &mut [u8]) -> Option<&[u8]> {
    let mut at = 0;
    while at < frame.len() {
        let distance = usize::from(frame[at]);
        if distance == 0 {
            return None;
        }
        frame[at] = 0;
        at += distance;
    }
    if at == frame.len() { frame.get(1..) } else { None }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::*;

    fn stuffed(body: &[u8]) -> Vec<u8> {
        let mut frame = vec![0; body.len() + 1];
        frame[1..].copy_from_slice(body);
        stuff(&mut frame);
        frame
    }

    /// Bodies of every length up to that of a frame, with zeros at various distances.
    fn bodies() -> impl Iterator<Item = Vec<u8>> {
        (0..=crate::limits::MAX_FRAME - 2).flat_map(|len| {
            (1..=9_usize)
                .map(move |stride| (0..len).map(|i| if i % stride == 0 { 0 } else { i as u8 }).collect())
        })
    }

    #[test]
    fn stuffing_agrees_with_the_cobs_crate() {
        for body in bodies() {
            assert_eq!(stuffed(&body), cobs::encode_vec(&body), "body {body:02x?}");
        }
    }

    #[test]
    fn unstuffing_restores_the_body() {
        for body in bodies() {
            assert_eq!(unstuff(&mut stuffed(&body)), Some(&body[..]));
        }
    }

    #[test]
    fn the_first_zero_is_found_at_any_position() {
        for len in 0..20 {
            let mut bytes = vec![1; len];
            assert_eq!(find_zero(&bytes), None);
            for first in (0..len).rev() {
                bytes[first] = 0;
                assert_eq!(find_zero(&bytes), Some(first), "{bytes:?}");
            }
        }
    }

    #[test]
    fn a_chain_with_another_end_is_rejected() {
        assert_eq!(unstuff(&mut [3, 1]), None);
        assert_eq!(unstuff(&mut [2, 7, 9]), None);
        assert_eq!(unstuff(&mut [1, 0, 1]), None);
        assert_eq!(unstuff(&mut []), None);
    }
}
