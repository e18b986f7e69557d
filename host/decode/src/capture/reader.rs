//! Reads the packets of a pcapng file, of this tool or of any other, with the `pcap-parser` crate.

use std::io;

use lashloop_protocol::layout::Direction;
use pcap_parser::nom;
use pcap_parser::pcapng::{
    Block, EnhancedPacketBlock, InterfaceDescriptionBlock, OptionCode, parse_block_be, parse_block_le,
};

use super::pcapng::{INBOUND, LINK_TYPE, MAGIC, OUTBOUND, PACKET_FLAGS};

const NANOSECONDS_PER_SECOND: u128 = 1_000_000_000;

/// One packet of the drive's link type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    /// Number in the file, from 1, as Wireshark counts: packets of other link types count too.
    pub number: u64,
    /// Time since the start of 1970.
    pub time_ns: u64,
    /// Its direction, if the file records one.
    pub direction: Option<Direction>,
    /// The bytes on the wire.
    pub bytes: Vec<u8>,
}

/// A capture that can't be read to its end.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file breaks off.
    #[error("the capture breaks off within a block, after packet {packets}")]
    Truncated {
        /// Packets read before.
        packets: u64,
    },
    /// The file violates the specification of pcapng.
    #[error("not a pcapng file as the specification asks, after packet {packets}")]
    Malformed {
        /// Packets read before.
        packets: u64,
    },
    /// The operating system refused.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// The packets of a capture of the whole file `bytes`. After an error there are no more.
pub fn packets(bytes: &[u8]) -> impl Iterator<Item = Result<Packet, ReadError>> {
    let mut reader = Reader { rest: bytes, big_endian: false, interfaces: Vec::new(), packets: 0 };
    std::iter::from_fn(move || reader.next())
}

struct Reader<'a> {
    rest: &'a [u8],
    big_endian: bool,
    /// Of the present section.
    interfaces: Vec<Interface>,
    packets: u64,
}

struct Interface {
    link_type: i32,
    /// Units of time in a second.
    resolution: u64,
    offset_s: i64,
}

impl Reader<'_> {
    fn next(&mut self) -> Option<Result<Packet, ReadError>> {
        while !self.rest.is_empty() {
            if self.is_too_short() {
                self.rest = &[];
                return Some(Err(ReadError::Malformed { packets: self.packets }));
            }
            let parse = if self.big_endian { parse_block_be } else { parse_block_le };
            let block = match parse(self.rest) {
                Ok((rest, block)) => {
                    self.rest = rest;
                    block
                }
                Err(error) => {
                    self.rest = &[];
                    let packets = self.packets;
                    return Some(Err(match error {
                        nom::Err::Incomplete(_) => ReadError::Truncated { packets },
                        nom::Err::Error(_) | nom::Err::Failure(_) => ReadError::Malformed { packets },
                    }));
                }
            };
            match block {
                Block::SectionHeader(header) => {
                    self.big_endian = header.big_endian();
                    self.interfaces.clear();
                }
                Block::InterfaceDescription(description) => self.interfaces.push(Interface::of(&description)),
                Block::EnhancedPacket(block) => {
                    self.packets += 1;
                    if let Some(packet) = self.packet(&block) {
                        return Some(Ok(packet));
                    }
                }
                Block::SimplePacket(_) => self.packets += 1,
                _ => {}
            }
        }
        None
    }

    /// Whether the block is shorter than its type and its two lengths. The parser subtracts them without a check.
    fn is_too_short(&self) -> bool {
        let length = self.rest.get(4..8).and_then(|bytes| bytes.first_chunk().copied());
        let length = length.map(if self.big_endian { u32::from_be_bytes } else { u32::from_le_bytes });
        // A section has its own order of bytes, and the parser checks its length.
        !self.rest.starts_with(&MAGIC) && length.is_some_and(|length| length < 12)
    }

    /// `None` for a packet of another link type.
    fn packet(&self, block: &EnhancedPacketBlock<'_>) -> Option<Packet> {
        let interface = self.interfaces.get(block.if_id as usize)?;
        if interface.link_type != i32::from(LINK_TYPE) {
            return None;
        }
        let flags = block.options.iter().find(|option| option.code == OptionCode(PACKET_FLAGS));
        let flags = flags.and_then(|option| option.value().first_chunk().copied());
        let flags = flags.map_or(0, |bytes| {
            if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
        });
        Some(Packet {
            number: self.packets,
            time_ns: interface.time_ns(block.ts_high, block.ts_low),
            direction: match flags & (INBOUND | OUTBOUND) {
                INBOUND => Some(Direction::DriveToHost),
                OUTBOUND => Some(Direction::HostToDrive),
                _ => None,
            },
            bytes: block.data.get(..block.caplen as usize)?.to_vec(),
        })
    }
}

impl Interface {
    fn of(description: &InterfaceDescriptionBlock<'_>) -> Self {
        Self {
            link_type: description.linktype.0,
            resolution: description.ts_resolution().unwrap_or(1_000_000),
            offset_s: description.ts_offset(),
        }
    }

    fn time_ns(&self, high: u32, low: u32) -> u64 {
        let units = u128::from(high) << 32 | u128::from(low);
        let time_ns = units * NANOSECONDS_PER_SECOND / u128::from(self.resolution);
        (time_ns as u64).wrapping_add_signed(self.offset_s.wrapping_mul(NANOSECONDS_PER_SECOND as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::super::pcapng;
    use super::*;

    fn file(packets: &[(u64, Direction, &[u8])]) -> Vec<u8> {
        let mut file = pcapng::file_header();
        for (time_ns, direction, bytes) in packets {
            pcapng::append_packet(&mut file, *time_ns, *direction, bytes);
        }
        file
    }

    #[test]
    fn written_packets_are_read_back_to_the_nanosecond() {
        let written = [
            (1_795_000_000_123_456_789, Direction::HostToDrive, &[1, 1, 0][..]),
            (1_795_000_000_123_456_790, Direction::DriveToHost, &[9; 4096][..]),
            (1_795_000_001_000_000_000, Direction::DriveToHost, &[0][..]),
        ];
        let read: Vec<_> = packets(&file(&written)).map(Result::unwrap).collect();
        assert_eq!(read.len(), written.len());
        for ((number, packet), (time_ns, direction, bytes)) in (1..).zip(&read).zip(written) {
            let expected = Packet { number, time_ns, direction: Some(direction), bytes: bytes.to_vec() };
            assert_eq!(*packet, expected);
        }
    }

    #[test]
    fn the_whole_packets_of_a_truncated_file_are_read() {
        let whole = file(&[(1, Direction::HostToDrive, &[5, 0]), (2, Direction::HostToDrive, &[6, 0])]);
        let read: Vec<_> = packets(&whole[..whole.len() - 1]).collect();
        assert!(
            matches!(&read[..], [Ok(first), Err(ReadError::Truncated { packets: 1 })] if first.number == 1)
        );
    }

    #[test]
    fn noise_is_no_capture() {
        let read: Vec<_> = packets(&[7; 64]).collect();
        assert!(matches!(&read[..], [Err(_)]), "{read:?}");
    }

    #[test]
    fn packets_of_other_link_types_are_omitted_and_counted() {
        let mut ethernet = file(&[(1, Direction::HostToDrive, &[5, 0])]);
        let link_type = ethernet.windows(2).position(|pair| pair == LINK_TYPE.to_le_bytes()).unwrap();
        ethernet[link_type] = 1;
        ethernet.extend(file(&[(1, Direction::HostToDrive, &[6, 0])]));
        let read: Vec<_> = packets(&ethernet).map(Result::unwrap).collect();
        assert_eq!(read.len(), 1);
        assert_eq!((read[0].number, &read[0].bytes[..]), (2, &[6, 0][..]));
    }

    #[test]
    fn a_block_shorter_than_its_head_is_malformed() {
        let block = [[1, 0, 0, 0x80], [10, 0, 0, 0], [0; 4]].concat();
        let read: Vec<_> = packets(&[file(&[]), block].concat()).collect();
        assert!(matches!(&read[..], [Err(ReadError::Malformed { packets: 0 })]), "{read:?}");
    }
}
