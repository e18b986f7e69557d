//! SIMD within a register: COBS distances and zeros of sixteen bytes in two words.

/// Bytes in a word.
pub(super) const WORD: usize = size_of::<u64>();

/// The lowest bit of every byte, and the highest.
const ONES: u64 = u64::from_ne_bytes([0x01; WORD]);
const HIGHS: u64 = ONES << 7;

/// Number of bytes before the first zero, and the words with each zero replaced by the distance to the next. A zero is assumed
/// after the last byte.
#[inline(always)]
pub(super) fn with_distances([low, high]: [u64; 2]) -> (usize, [u64; 2]) {
    let others = [low, high].map(others_in);
    let [low_chain, high_chain] = others.map(|others| &CHAINS[others]);
    let first = (!(others[0] | others[1] << WORD)).trailing_zeros() as usize;
    let first_of_high = u64::from((!others[1]).trailing_zeros());
    let low = low | (low_chain.distances + low_chain.last * first_of_high);
    (first, [low, high | high_chain.distances])
}

/// The words with the bytes cleared whose bit in `bytes` is set.
#[inline(always)]
pub(super) fn without([low, high]: [u64; 2], bytes: usize) -> [u64; 2] {
    [low & KEPT[bytes & 0xff], high & KEPT[bytes >> WORD & 0xff]]
}

/// Whether any byte is zero.
#[inline(always)]
pub(super) fn has_zero(words: [u64; 2]) -> bool {
    let [low, high] = words.map(|word| word.wrapping_sub(ONES) & !word);
    (low | high) & HIGHS != 0
}

/// Bit `n` is set unless byte `n` of the word is zero.
#[inline(always)]
fn others_in(word: u64) -> usize {
    const LOW_BITS: u64 = !HIGHS;
    // The highest bit of each byte, set unless all eight are zero; no sum carries into the next byte.
    let others = (((word & LOW_BITS) + LOW_BITS) | word) & HIGHS;
    // Gathered in the highest byte.
    (others.wrapping_mul(0x0002_0408_1020_4081) >> 56) as usize
}

/// The distances in a word.
#[derive(Clone, Copy)]
struct Chain {
    /// In each zero byte, the distance to the next; in the last zero byte, to the end of the word.
    distances: u64,
    /// 1 in the last zero byte, whose distance lacks the bytes from the end of the word to the next zero.
    last: u64,
}

/// The distances for each set of bytes that are not zero.
static CHAINS: [Chain; 256] = {
    let mut chains = [Chain { distances: 0, last: 0 }; 256];
    let mut others = 0;
    while others < chains.len() {
        let (mut byte, mut next) = (WORD, WORD);
        while byte > 0 {
            byte -= 1;
            if others >> byte & 1 == 0 {
                let one = 1 << (8 * byte);
                chains[others].distances |= (next - byte) as u64 * one;
                if next == WORD {
                    chains[others].last = one;
                }
                next = byte;
            }
        }
        others += 1;
    }
    chains
};

/// For each set of bytes, the mask that clears them.
static KEPT: [u64; 256] = {
    let mut masks = [u64::MAX; 256];
    let mut set = 0;
    while set < masks.len() {
        let mut byte = 0;
        while byte < WORD {
            if set >> byte & 1 == 1 {
                masks[set] &= !(0xff << (8 * byte));
            }
            byte += 1;
        }
        set += 1;
    }
    masks
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cobs;

    /// Sixteen bytes, zero where a bit is set and `other` elsewhere.
    fn bytes(zeros: usize, other: u8) -> [u8; 2 * WORD] {
        core::array::from_fn(|at| if zeros >> at & 1 == 1 { 0 } else { other })
    }

    fn words(bytes: [u8; 2 * WORD]) -> [u64; 2] {
        let [low, high] = bytes.as_chunks().0 else { unreachable!("sixteen bytes are two words") };
        [u64::from_le_bytes(*low), u64::from_le_bytes(*high)]
    }

    #[test]
    fn distances_are_those_of_cobs_and_can_be_removed() {
        for zeros in 0..=usize::from(u16::MAX) {
            for other in [0x01, 0x7f, 0x80, 0xff] {
                let plain = bytes(zeros, other);
                let mut stuffed = [0; 1 + 2 * WORD];
                stuffed[1..].copy_from_slice(&plain);
                cobs::stuff(&mut stuffed);

                let (first, stuffed_words) = with_distances(words(plain));
                assert_eq!(first + 1, usize::from(stuffed[0]), "{plain:02x?}");
                assert_eq!(stuffed_words.map(u64::to_le_bytes).as_flattened(), &stuffed[1..], "{plain:02x?}");
                assert_eq!(without(stuffed_words, zeros), words(plain));
                assert_eq!(has_zero(words(plain)), zeros != 0, "{plain:02x?}");
                assert!(!has_zero(stuffed_words), "{plain:02x?}");
            }
        }
    }
}
