//! Bytes in writes that every drive takes.

use crate::prelude::wire::*;

/// Requests that a drive takes at once in `Idle`, and bytes, whichever are fewer.
pub(super) const MOST_REQUESTS: usize = 17;
pub(super) const MOST_BYTES: usize = 320;

/// Length of the first write of these bytes: as many as every drive takes at once, or a single frame.
pub(super) fn next_write(bytes: &[u8], is_alone: bool) -> usize {
    let (most, shortest) = if is_alone { (1, 0) } else { (MOST_REQUESTS, OVERHEAD) };
    let (mut frame, mut requests, mut end) = (0, 0, None);
    for (place, byte) in bytes.iter().enumerate().take(MOST_BYTES) {
        if *byte != DELIMITER {
            frame += 1;
            continue;
        }
        // Fewer bytes aren't a request. One alone ends with any delimiter, as that may end what was sent before.
        requests += usize::from(frame >= shortest);
        (frame, end) = (0, Some(place + 1));
        if requests == most {
            return place + 1;
        }
    }
    if bytes.len() <= MOST_BYTES { bytes.len() } else { end.unwrap_or(MOST_BYTES) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REQUEST: [u8; 8] = [8, 1, 1, 1, 1, 1, 1, 0];

    #[test]
    fn a_write_ends_with_a_frame_and_within_its_bounds() {
        assert_eq!(next_write(&REQUEST.repeat(40), false), 17 * 8);
        assert_eq!(next_write(&REQUEST[..5], false), 5);
        assert_eq!(next_write(&[REQUEST, REQUEST].concat()[..11], false), 11);
        assert_eq!(next_write(&[1; 1_000], false), 320);
        assert_eq!(next_write(&[1, 0].repeat(400), false), 320);
        assert_eq!(next_write(&[&[7; 18][..], &[0]].concat().repeat(40), false), 16 * 19);
    }

    #[test]
    fn a_frame_is_sent_alone_where_it_has_to_be() {
        assert_eq!(next_write(&REQUEST.repeat(40), true), 8);
        assert_eq!(next_write(&[&[0, 0], &REQUEST[..], &[5]].concat(), true), 1);
        assert_eq!(next_write(&[1, 0].repeat(400), true), 2);
    }
}
