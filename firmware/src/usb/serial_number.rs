//! The chip's unique id as a serial number of USB.

use heapless::String;

/// 24 hexadecimal digits.
pub type SerialNumber = String<24>;

/// The serial number of a chip: the three words of its unique id (RM0090 39.1), the most significant first.
#[must_use]
pub fn serial_number(unique_id: [u32; 3]) -> SerialNumber {
    let nibbles =
        unique_id.into_iter().rev().flat_map(|word| (0..8).rev().map(move |at| word >> (4 * at) & 0xf));
    // No formatting: it would cost the image kilobytes.
    nibbles
        .filter_map(|nibble| char::from_digit(nibble, 16))
        .map(|digit| digit.to_ascii_uppercase())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::serial_number;

    #[test]
    fn every_bit_of_the_unique_id_is_in_the_serial_number() {
        assert_eq!(serial_number([0x0000_002a, 0x3131_5113, 0x3137_3633]), "31373633313151130000002A");
        for bit in 0..96 {
            let mut unique_id = [0; 3];
            unique_id[bit / 32] = 1_u32 << (bit % 32);
            assert_ne!(serial_number(unique_id), serial_number([0; 3]), "bit {bit}");
        }
    }
}
