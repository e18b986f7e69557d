//! Thumb instructions for mutants of an image (ARMv7-M Architecture Reference Manual, A7.7).

/// `bx lr`: return to the caller.
pub const RETURN: u16 = 0x4770;
/// `nop`.
pub const NOTHING: u16 = 0xbf00;
/// `wfi`.
pub const WAIT_FOR_INTERRUPT: u16 = 0xbf30;
/// `udf #0`: undefined.
pub const UNDEFINED: u16 = 0xde00;
/// `b .`: an endless loop.
pub const FOREVER: u16 = 0xe7fe;
/// `cpsid i`: mask all interrupts.
pub const MASK_INTERRUPTS: u16 = 0xb672;

/// Instructions and data, in the order of their addresses.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Code(pub(crate) Vec<u8>);

impl Code {
    /// Appends one halfword.
    #[must_use]
    pub fn halfword(mut self, halfword: u16) -> Self {
        self.0.extend(halfword.to_le_bytes());
        self
    }

    /// Appends halfwords.
    #[must_use]
    pub fn halfwords(self, halfwords: &[u16]) -> Self {
        halfwords.iter().fold(self, |code, halfword| code.halfword(*halfword))
    }

    /// The words of this code in memory.
    #[must_use]
    pub fn words(&self) -> Vec<u32> {
        let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
        self.0.chunks(4).map(word).collect()
    }

    /// Appends a word of data.
    #[must_use]
    pub fn word(mut self, word: u32) -> Self {
        self.0.extend(word.to_le_bytes());
        self
    }

    /// `movw`, `movt`: loads a register.
    #[must_use]
    pub fn load(self, register: u16, value: u32) -> Self {
        self.movw(register, value as u16).half_of_register(0xf2c0, register, (value >> 16) as u16)
    }

    /// `movw`: loads a register with 16 bits.
    #[must_use]
    pub fn movw(self, register: u16, value: u16) -> Self {
        self.half_of_register(0xf240, register, value)
    }

    /// Encoding T3 of `mov` and T1 of `movt`: the value in the fields imm4, i, imm3 and imm8.
    fn half_of_register(self, opcode: u16, register: u16, value: u16) -> Self {
        let first = opcode | (value >> 12) | ((value >> 11) & 1) << 10;
        let second = ((value >> 8) & 7) << 12 | register << 8 | (value & 0xff);
        self.halfwords(&[first, second])
    }

    /// `bl`, encoding T1, of an instruction at `from`: calls the function at `to`.
    #[must_use]
    pub fn call(self, from: u64, to: u64) -> Self {
        let offset = (to as u32).wrapping_sub(from as u32 + 4);
        let bit = |number: u32| (offset >> number) & 1;
        // J1 and J2 are the bits 23 and 22, inverted unless the sign is set.
        let (j1, j2) = (!(bit(23) ^ bit(24)) & 1, !(bit(22) ^ bit(24)) & 1);
        let first = 0xf000 | bit(24) << 10 | (offset >> 12) & 0x3ff;
        let second = 0xd000 | j1 << 13 | j2 << 11 | (offset >> 1) & 0x7ff;
        self.halfwords(&[first as u16, second as u16])
    }

    /// `bx`: jumps to the function at this address.
    #[must_use]
    pub fn jump(self, address: u64) -> Self {
        // Register r3; bit 0 selects Thumb.
        self.load(3, address as u32 | 1).halfword(0x4718)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_halfword_is_the_lower_half_of_a_word() {
        let code = Code::default().halfwords(&[0x2100, RETURN, UNDEFINED]);
        assert_eq!(code.words(), [0x4770_2100, 0xde00]);
    }

    #[test]
    fn a_load_has_the_encoding_of_an_assembler() {
        // movw r0, #17408; movt r0, #16384 and movw lr, #1208, of a disassembly.
        let code = Code::default().load(0, 0x4000_4400).movw(14, 1208);
        // bl 0x080054e4 at 0x080055de, and bl 0x08008200 at 0x08005550.
        assert_eq!(Code::default().call(0x0800_55de, 0x0800_54e4).0, [0xff, 0xf7, 0x81, 0xff]);
        assert_eq!(Code::default().call(0x0800_5550, 0x0800_8200).0, [0x02, 0xf0, 0x56, 0xfe]);
        assert_eq!(code.0, [0x44, 0xf2, 0x00, 0x40, 0xc4, 0xf2, 0x00, 0x00, 0x40, 0xf2, 0xb8, 0x4e]);
    }
}
