//! What a drive can do beyond what every drive must, as flags of its identity.

bitflags::bitflags! {
    /// What a drive can do beyond what every drive must.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Capabilities: u8 {
        /// Every message with the optional field `device_time_us` carries it.
        const DEVICE_TIME = 0x01;
        /// The drive has encoders and a power stage of its own: the parameter `sample_source` selects them.
        const BENCH_MODE = 0x02;
        /// `EnterLoader` starts a boot loader.
        const LOADER = 0x04;
        /// The drive stores its parameters.
        const STORE = 0x08;
        /// The drive captures signals.
        const CAPTURE = 0x10;
    }
}

flag_set!(Capabilities);
wire_flags!(Capabilities);
