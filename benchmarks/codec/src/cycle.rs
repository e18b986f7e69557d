//! The messages of a control cycle as plain values, and those of a run.

use lashloop_protocol::EncoderCounts;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Messages measured in one round.
pub const COUNT: usize = 4096;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub sequence: u16,
    /// 24 bits with their sign, as of the load.
    pub motor_counts: i32,
    pub load_counts: i32,
    pub reference_rad: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque {
    pub sequence: u16,
    pub torque_nm: f32,
    /// 1 to 5.
    pub state: u8,
    /// Three bits: 0x10, 0x20 and 0x40.
    pub flags: u8,
    pub compute_tenths_us: u16,
}

/// Samples of four seconds in the middle of a run: consecutive sequences, random counts and references.
pub fn samples() -> Vec<Sample> {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    (0..COUNT as u16)
        .map(|k| Sample {
            sequence: 10_000 + k,
            motor_counts: random.next_u32().cast_signed() >> 13,
            load_counts: random.next_u32().cast_signed() >> 14,
            reference_rad: random.next_u32() as f32 / 2_f32.powi(31),
        })
        .collect()
}

/// The torques for these samples.
pub fn torques() -> Vec<Torque> {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    (0..COUNT as u16)
        .map(|k| Torque {
            sequence: 10_000 + k,
            torque_nm: random.next_u32().cast_signed() as f32 / 2_f32.powi(27),
            state: 4,
            flags: u8::from(random.next_u32().is_multiple_of(8)) << 4,
            compute_tenths_us: (random.next_u32() % 400) as u16,
        })
        .collect()
}

/// Extremes of 24 bits.
const EXTREME_COUNTS: [i32; 4] = [0, -1, EncoderCounts::MIN.get(), EncoderCounts::MAX.get()];

/// Samples of all values at which encodings are longest or shortest.
pub fn extreme_samples() -> Vec<Sample> {
    let mut samples = Vec::new();
    for sequence in [0, u16::MAX] {
        for motor_counts in EXTREME_COUNTS {
            for load_counts in EXTREME_COUNTS {
                for reference_rad in [0.0, f32::MIN, f32::MIN_POSITIVE, std::f32::consts::PI] {
                    samples.push(Sample { sequence, motor_counts, load_counts, reference_rad });
                }
            }
        }
    }
    samples
}

/// The same for torques.
pub fn extreme_torques() -> Vec<Torque> {
    let mut torques = Vec::new();
    for sequence in [0, u16::MAX] {
        for torque_nm in [0.0, f32::MIN, f32::MIN_POSITIVE, std::f32::consts::PI] {
            for flags in [0, 0x70] {
                for compute_tenths_us in [0, u16::MAX] {
                    torques.push(Torque { sequence, torque_nm, state: 5, flags, compute_tenths_us });
                }
            }
        }
    }
    torques
}
