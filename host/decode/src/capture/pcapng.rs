//! The three blocks of pcapng (draft-ietf-opsawg-pcapng) that a capture needs, in little endian.
//!
//! ```text
//! every block   type u32 | total length u32 | body, padded to 4 bytes | total length u32
//! SHB           byte-order magic u32 | version 1.0, 2 x u16 | section length unknown, u64 | options
//! IDB           link type u16 | 0 u16 | snap length 0 (no limit) u32 | options
//! EPB           interface u32 | time, upper then lower half, 2 x u32 | captured, original length 2 x u32 | bytes
//!               | options
//! option        code u16 | length u16 | value, padded to 4 bytes; code 0 ends the list
//! ```

use lashloop_protocol::layout::Direction;

/// The first four bytes of every pcapng file.
pub const MAGIC: [u8; 4] = 0x0a0d_0d0a_u32.to_le_bytes();

/// `LINKTYPE_USER0`: no registered link type; the dissector claims it.
pub const LINK_TYPE: u16 = 147;

const INTERFACE_DESCRIPTION: u32 = 1;
const ENHANCED_PACKET: u32 = 6;
const BYTE_ORDER_MAGIC: u32 = 0x1a2b_3c4d;
const UNKNOWN_LENGTH: u64 = u64::MAX;

const END_OF_OPTIONS: u16 = 0;
const USER_APPLICATION: u16 = 4;
const INTERFACE_NAME: u16 = 2;
const TIME_RESOLUTION: u16 = 9;
/// Times count in 10^-9 s.
const NANOSECONDS: u8 = 9;
/// `epb_flags`; the lowest two bits are the direction.
pub(super) const PACKET_FLAGS: u16 = 2;
pub(super) const INBOUND: u32 = 1;
pub(super) const OUTBOUND: u32 = 2;

/// The start of a file: one section and one interface, the line to the drive.
#[must_use]
pub fn file_header() -> Vec<u8> {
    let mut out = Vec::new();
    block(&mut out, u32::from_le_bytes(MAGIC), |out| {
        out.extend(BYTE_ORDER_MAGIC.to_le_bytes());
        out.extend([1, 0, 0, 0]);
        out.extend(UNKNOWN_LENGTH.to_le_bytes());
        option(out, USER_APPLICATION, concat!("lashloop ", env!("CARGO_PKG_VERSION")).as_bytes());
        option(out, END_OF_OPTIONS, &[]);
    });
    block(&mut out, INTERFACE_DESCRIPTION, |out| {
        out.extend(LINK_TYPE.to_le_bytes());
        out.extend([0; 6]);
        option(out, INTERFACE_NAME, b"drive");
        option(out, TIME_RESOLUTION, &[NANOSECONDS]);
        option(out, END_OF_OPTIONS, &[]);
    });
    out
}

/// Appends a packet. `time_ns` counts from the start of 1970. The host captures, so a frame to the drive is
/// outbound.
pub fn append_packet(out: &mut Vec<u8>, time_ns: u64, direction: Direction, bytes: &[u8]) {
    let flags = match direction {
        Direction::HostToDrive => OUTBOUND,
        Direction::DriveToHost => INBOUND,
    };
    let len = (bytes.len() as u32).to_le_bytes();
    block(out, ENHANCED_PACKET, |out| {
        out.extend([0; 4]);
        out.extend(((time_ns >> 32) as u32).to_le_bytes());
        out.extend((time_ns as u32).to_le_bytes());
        out.extend(len);
        out.extend(len);
        out.extend_from_slice(bytes);
        pad(out, bytes.len());
        option(out, PACKET_FLAGS, &flags.to_le_bytes());
        option(out, END_OF_OPTIONS, &[]);
    });
}

fn block(out: &mut Vec<u8>, ty: u32, body: impl FnOnce(&mut Vec<u8>)) {
    let start = out.len();
    out.extend(ty.to_le_bytes());
    out.extend([0; 4]);
    body(out);
    let total = ((out.len() - start + 4) as u32).to_le_bytes();
    out.extend(total);
    out[start + 4..start + 8].copy_from_slice(&total);
}

fn option(out: &mut Vec<u8>, code: u16, value: &[u8]) {
    out.extend(code.to_le_bytes());
    out.extend((value.len() as u16).to_le_bytes());
    out.extend_from_slice(value);
    pad(out, value.len());
}

fn pad(out: &mut Vec<u8>, len: usize) {
    out.resize(out.len() + len.next_multiple_of(4) - len, 0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packet_is_the_block_of_the_specification() {
        let mut out = Vec::new();
        append_packet(&mut out, 0x0123_4567_89ab_cdef, Direction::DriveToHost, &[3, 7, 9, 1, 0]);
        let expected: [&[u8]; 8] = [
            &[6, 0, 0, 0, 52, 0, 0, 0],
            &[0, 0, 0, 0],
            &[0x67, 0x45, 0x23, 0x01, 0xef, 0xcd, 0xab, 0x89],
            &[5, 0, 0, 0, 5, 0, 0, 0],
            &[3, 7, 9, 1, 0, 0, 0, 0],
            &[2, 0, 4, 0, 1, 0, 0, 0],
            &[0, 0, 0, 0],
            &[52, 0, 0, 0],
        ];
        assert_eq!(out, expected.concat());
    }

    #[test]
    fn blocks_of_any_frame_end_on_four_bytes() {
        for len in 0..=64 {
            let mut out = Vec::new();
            append_packet(&mut out, 0, Direction::HostToDrive, &vec![1; len]);
            assert_eq!(out.len() % 4, 0, "{len}");
            assert_eq!(out[4..8], out[out.len() - 4..], "{len}: the length at both ends");
            assert_eq!(u32::from_le_bytes(out[4..8].try_into().unwrap()) as usize, out.len());
        }
    }
}
