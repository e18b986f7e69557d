//! How a message packs its values: by CDR, as ROS 2 does. Behind a head of four bytes every number is at a multiple of its
//! size. Records of format 2 have the packing of ROS 1, without head and padding; it is only read.

/// Profile of the files, as MCAP names it.
pub(crate) const PROFILE: &str = "ros2";
/// Encoding of the messages, as MCAP names it.
pub const MESSAGE_ENCODING: &str = "cdr";
/// Encoding of the schemas, as MCAP names it.
pub const SCHEMA_ENCODING: &str = "ros2msg";

/// Plain CDR, little endian, without options.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// A packing that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Cdr,
    Ros1,
}

impl Packing {
    /// The packing of an encoding, as MCAP names it.
    pub(super) fn named(encoding: &str) -> Option<Self> {
        match encoding {
            MESSAGE_ENCODING => Some(Self::Cdr),
            "ros1" => Some(Self::Ros1),
            _ => None,
        }
    }
}

/// Begins a message anew.
pub(crate) fn begin(message: &mut Vec<u8>) {
    message.clear();
    message.extend_from_slice(&HEAD);
}

/// Appends the bytes of a number.
pub(super) fn push<const N: usize>(number: [u8; N], message: &mut Vec<u8>) {
    while !(message.len() - HEAD.len()).is_multiple_of(N) {
        message.push(0);
    }
    message.extend_from_slice(&number);
}

/// Appends a text: its length with a zero at its end, then its bytes.
pub(super) fn push_text(text: &str, message: &mut Vec<u8>) {
    push((text.len() as u32 + 1).to_le_bytes(), message);
    message.extend_from_slice(text.as_bytes());
    message.push(0);
}

/// A message that is read value by value.
pub(super) struct Unpacker<'a> {
    packing: Packing,
    body: &'a [u8],
    at: usize,
}

impl<'a> Unpacker<'a> {
    /// Begins a message; `None` for another head.
    pub(super) fn new(packing: Packing, message: &'a [u8]) -> Option<Self> {
        let body = match packing {
            Packing::Cdr => message.strip_prefix(&HEAD)?,
            Packing::Ros1 => message,
        };
        Some(Self { packing, body, at: 0 })
    }

    /// The bytes of the next number; `None` if they are too few.
    pub(super) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        if self.packing == Packing::Cdr {
            self.at = self.at.next_multiple_of(N);
        }
        let number = self.body.get(self.at..)?.first_chunk()?;
        self.at += N;
        Some(*number)
    }

    /// The next text.
    pub(super) fn text(&mut self) -> Option<String> {
        let length = u32::from_le_bytes(self.take()?) as usize;
        let text = self.body.get(self.at..)?.get(..length)?;
        self.at += length;
        let text = match self.packing {
            Packing::Cdr => text.strip_suffix(&[0])?,
            Packing::Ros1 => text,
        };
        Some(String::from_utf8_lossy(text).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_has_the_bytes_of_cdr() {
        let mut message = vec![7];
        begin(&mut message);
        push([0xaa], &mut message);
        push_text("gap", &mut message);
        push([0xbb], &mut message);
        push(1.0_f64.to_le_bytes(), &mut message);
        let expected: [&[u8]; 7] = [
            &[0x00, 0x01, 0x00, 0x00],
            &[0xaa, 0, 0, 0],
            &[4, 0, 0, 0],
            b"gap\0",
            &[0xbb, 0, 0, 0],
            &[0, 0, 0, 0, 0, 0, 0xf0, 0x3f],
            &[],
        ];
        assert_eq!(message, expected.concat());
        let mut read = Unpacker::new(Packing::Cdr, &message).expect("a head");
        assert_eq!((read.take(), read.text(), read.take()), (Some([0xaa]), Some("gap".into()), Some([0xbb])));
        assert_eq!((read.take().map(f64::from_le_bytes), read.take::<1>()), (Some(1.0), None));
        assert!(Unpacker::new(Packing::Cdr, &message[1..]).is_none(), "another head");
    }

    #[test]
    fn a_message_of_ros_1_is_read() {
        let message = [&[0xaa][..], &[3, 0, 0, 0], b"gap", &2_u32.to_le_bytes()].concat();
        let mut read = Unpacker::new(Packing::Ros1, &message).expect("no head");
        assert_eq!(
            (read.take(), read.text(), read.take()),
            (Some([0xaa]), Some("gap".into()), Some([2, 0, 0, 0]))
        );
        assert_eq!((read.take::<1>(), read.text()), (None, None));
    }
}
