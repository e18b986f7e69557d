//! Measures all sides in turn, round after round, and computes medians.

use std::hint::black_box;
use std::time::Instant;

use crate::codec::Codec;
use crate::cycle::{COUNT, Sample, Torque, extreme_samples, extreme_torques};

const ROUNDS: usize = 201;

/// Cost of one kind of message.
pub struct Cost {
    pub encode_ns: f64,
    pub decode_ns: f64,
    pub bytes: Length,
}

/// Length of frames, in bytes.
#[derive(Clone, Copy)]
pub struct Length {
    /// Mean over the values of the run.
    pub mean: f64,
    /// Maximum over these and the extreme values.
    pub longest: usize,
}

pub struct Figures {
    pub name: &'static str,
    pub checked: bool,
    pub sample: Cost,
    pub torque: Cost,
}

/// Timed tasks: sample and torque, encoding and decoding.
const TASKS: usize = 4;

/// A codec with values to encode and frames to decode.
pub trait Side {
    fn name(&self) -> &'static str;

    /// Whether the codec detects damage.
    fn checked(&self) -> bool;

    /// Lengths of the frames of a sample and of a torque.
    fn bytes(&self) -> [Length; 2];

    /// Runs one task for all values and returns ns per message.
    fn round(&mut self, task: usize) -> f64;
}

impl dyn Side {
    pub fn of<C>(name: &'static str, samples: &[Sample], torques: &[Torque]) -> Box<dyn Side>
    where
        C: Codec<Sample> + Codec<Torque> + 'static,
    {
        let mut codec = C::default();
        let samples = Work::new(&mut codec, samples, &extreme_samples());
        let torques = Work::new(&mut codec, torques, &extreme_torques());
        Box::new(Timed { name, codec, samples, torques })
    }
}

struct Timed<C> {
    name: &'static str,
    codec: C,
    samples: Work<Sample>,
    torques: Work<Torque>,
}

impl<C: Codec<Sample> + Codec<Torque>> Side for Timed<C> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn checked(&self) -> bool {
        <C as Codec<Sample>>::CHECKED && <C as Codec<Torque>>::CHECKED
    }

    fn bytes(&self) -> [Length; 2] {
        [self.samples.bytes(), self.torques.bytes()]
    }

    fn round(&mut self, task: usize) -> f64 {
        match task {
            0 => self.samples.encode(&mut self.codec),
            1 => self.samples.decode(&mut self.codec),
            2 => self.torques.encode(&mut self.codec),
            _ => self.torques.decode(&mut self.codec),
        }
    }
}

struct Work<V> {
    values: Vec<V>,
    /// Consecutive frames, as received from a line.
    line: Vec<u8>,
    lengths: Vec<usize>,
    longest: usize,
}

impl<V: Copy + PartialEq + std::fmt::Debug> Work<V> {
    fn new(codec: &mut impl Codec<V>, values: &[V], extremes: &[V]) -> Self {
        let (mut line, mut lengths) = (Vec::new(), Vec::new());
        for value in values {
            codec.encode(value, |bytes| {
                line.extend_from_slice(bytes);
                lengths.push(bytes.len());
            });
        }
        let mut longest = 0;
        for value in values.iter().chain(extremes) {
            codec.encode(value, |bytes| longest = longest.max(bytes.len()));
        }
        let this = Self { values: values.to_vec(), line, lengths, longest };
        for (value, frame) in values.iter().zip(this.frames()) {
            assert_eq!(codec.decode(frame), *value, "decodes to the same value");
        }
        this
    }

    fn frames(&self) -> impl Iterator<Item = &[u8]> {
        let mut line = &self.line[..];
        self.lengths.iter().map(move |&len| line.split_off(..len).expect("one length per frame"))
    }

    fn bytes(&self) -> Length {
        Length { mean: self.line.len() as f64 / COUNT as f64, longest: self.longest }
    }

    #[inline(never)]
    fn encode(&self, codec: &mut impl Codec<V>) -> f64 {
        let started = Instant::now();
        for value in &self.values {
            codec.encode(black_box(value), |bytes| {
                black_box(bytes);
            });
        }
        started.elapsed().as_nanos() as f64 / COUNT as f64
    }

    #[inline(never)]
    fn decode(&self, codec: &mut impl Codec<V>) -> f64 {
        let started = Instant::now();
        for frame in self.frames() {
            black_box(&codec.decode(black_box(frame)));
        }
        started.elapsed().as_nanos() as f64 / COUNT as f64
    }
}

/// Runs all sides and returns their medians, in the order of the sides.
pub fn measure(sides: &mut [Box<dyn Side>]) -> Vec<Figures> {
    let mut times = vec![[const { Vec::new() }; TASKS]; sides.len()];
    for _ in 0..ROUNDS {
        for task in 0..TASKS {
            for (side, times) in sides.iter_mut().zip(&mut times) {
                times[task].push(side.round(task));
            }
        }
    }
    sides
        .iter()
        .zip(times)
        .map(|(side, times)| {
            let [se, sd, te, td] = times.map(median);
            let [sample, torque] = side.bytes();
            Figures {
                name: side.name(),
                checked: side.checked(),
                sample: Cost { encode_ns: se, decode_ns: sd, bytes: sample },
                torque: Cost { encode_ns: te, decode_ns: td, bytes: torque },
            }
        })
        .collect()
}

pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
