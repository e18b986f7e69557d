//! The source of the core clock, and the crystal: measured and not believed.
//!
//! A timer counts periods of the low-speed oscillator, once with the internal oscillator as its clock and once with the crystal. The
//! quotient is that of the two clocks; the frequency of the low-speed oscillator, 17 to 47 kHz, cancels.

/// Source of the core clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClockSource {
    /// QEMU: always 168 MHz, without a clock tree to configure.
    Emulator,
    /// The crystal, about 50 ppm.
    Crystal,
    /// The internal RC oscillator, 1 % at room temperature: accurate enough for the link, not for timing.
    InternalOscillator(Unusable),
}

/// Why the crystal isn't used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unusable {
    /// It doesn't start.
    Silent,
    /// Its frequency isn't known to the clock tree.
    UnknownFrequency,
}

impl ClockSource {
    /// What the drive logs if it can't have bench mode.
    pub(super) fn reason_against_bench_mode(self) -> Option<&'static str> {
        match self {
            // Its periods are too inaccurate for a motor, and nothing would notice that it drifts.
            Self::InternalOscillator(Unusable::Silent) => Some("no crystal: clock 1% RC, no bench mode"),
            Self::InternalOscillator(Unusable::UnknownFrequency) => {
                Some("no known crystal: clock 1% RC, no bench mode")
            }
            // A core that waits at a breakpoint turns no motor off in time.
            Self::Crystal if cfg!(feature = "debug") => Some("image for a debugger: no bench mode"),
            Self::Crystal | Self::Emulator => None,
        }
    }
}

/// Crystals that the clock trees take to 168 and 48 MHz.
const KNOWN_HZ: [u32; 4] = [8_000_000, 12_000_000, 16_000_000, 25_000_000];
/// A crystal that differs by more than one part in this is another one.
const TOLERANCE: u32 = 20;
/// Captures in a measurement, each of [`PERIODS_PER_CAPTURE`] periods.
const CAPTURES: usize = 4;
/// By the prescaler of the capture.
pub(super) const PERIODS_PER_CAPTURE: u8 = 8;

/// A timer whose clock is that of the core, before the clock tree is configured, with captures of the low-speed oscillator.
pub(super) trait Stopwatch {
    /// The internal oscillator, to 1 % at room temperature and 4 % from -10 to 85 degrees Celsius.
    const INTERNAL_KHZ: u32;
    /// The largest count.
    const MAX: u32;

    /// The count at the next capture.
    fn capture(&mut self) -> Option<u32>;

    /// Runs the core from the crystal, or from the internal oscillator again. Returns whether it does.
    fn run_from_crystal(&mut self, from_crystal: bool) -> bool;
}

/// The frequency of the crystal in Hz, if it is a known one. The core has to run from the internal oscillator, and does so
/// afterwards; the crystal has to run.
pub(super) fn crystal_hz<S: Stopwatch>(mut stopwatch: S) -> Option<u32> {
    let internal = counts(&mut stopwatch)?;
    if !stopwatch.run_from_crystal(true) {
        return None;
    }
    // If the crystal stops meanwhile, the clock security system of an STM32F4 ends the start. That of an STM32H7, which only a reset
    // turns off again, isn't on yet: the core stops, with every output as after a reset.
    let crystal = counts(&mut stopwatch);
    stopwatch.run_from_crystal(false);
    // At most 4 times 8 periods of 17 kHz at 64 MHz: 121,000 counts.
    let khz = u64::from(crystal?) * u64::from(S::INTERNAL_KHZ) / u64::from(internal.max(1));
    KNOWN_HZ
        .into_iter()
        .find(|known_hz| u64::from(known_hz / 1_000).abs_diff(khz) <= u64::from(known_hz / 1_000 / TOLERANCE))
}

/// Counts of the timer from one capture to the [`CAPTURES`]th after the next.
fn counts<S: Stopwatch>(stopwatch: &mut S) -> Option<u32> {
    // The period that is being counted began with another clock.
    stopwatch.capture()?;
    let mut last = stopwatch.capture()?;
    let mut sum = 0;
    for _ in 0..CAPTURES {
        let next = stopwatch.capture()?;
        sum += next.wrapping_sub(last) & S::MAX;
        last = next;
    }
    Some(sum)
}
