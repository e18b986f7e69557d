//! Properties of a parameter, as flags of its description.

bitflags::bitflags! {
    /// Properties of a parameter.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct ParameterFlags: u8 {
        /// The parameter may also be set in `Armed` and `Running`.
        const LIVE = 0x01;
        /// Every value has a name, which `DescribeChoice` requests. The type is `U32`, the largest value at most 255.
        const CHOICES = 0x02;
    }
}

flag_set!(ParameterFlags);
wire_flags!(ParameterFlags);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Wire;

    #[test]
    fn bits_without_a_name_are_kept() {
        for byte in 0..=u8::MAX {
            let flags = ParameterFlags::get(&[byte]).expect("any bits are flags");
            let mut put = [0];
            flags.put(&mut put);
            assert_eq!(put, [byte]);
            assert_eq!(flags.contains(ParameterFlags::LIVE), byte & 1 != 0);
            assert_eq!(flags.contains(ParameterFlags::CHOICES), byte & 2 != 0);
        }
    }
}
