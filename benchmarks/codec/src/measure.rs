//! Measures all sides in turn, round after round, and computes medians.

use std::hint::black_box;
use std::rc::Rc;
use std::time::Instant;

use crate::codec::Codec;
use crate::cycle::{COUNT, Sample, Torque, extreme_samples, extreme_torques};

const ROUNDS: usize = 201;

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
    /// Whether the codec detects damage.
    pub checked: bool,
    /// Time per message of each task, in ns.
    pub ns: [f64; TASKS],
    /// Lengths of the frames of a sample and of a torque.
    pub bytes: [Length; 2],
}

/// Timed tasks: encode a sample, decode it, encode a torque, decode it.
const TASKS: usize = 4;

/// A codec with values to encode and frames to decode.
pub struct Side {
    name: &'static str,
    checked: bool,
    /// Lengths of the frames of a sample and of a torque.
    bytes: [Length; 2],
    /// Each runs once for all values and returns ns per message.
    tasks: [Box<dyn FnMut() -> f64>; TASKS],
}

impl Side {
    pub fn of<C>(name: &'static str, samples: &[Sample], torques: &[Torque]) -> Self
    where
        C: Codec<Sample> + Codec<Torque> + 'static,
    {
        let checked = <C as Codec<Sample>>::CHECKED && <C as Codec<Torque>>::CHECKED;
        let (sample, [sample_encode, sample_decode]) = tasks::<C, _>(samples, &extreme_samples());
        let (torque, [torque_encode, torque_decode]) = tasks::<C, _>(torques, &extreme_torques());
        let tasks = [sample_encode, sample_decode, torque_encode, torque_decode];
        Self { name, checked, bytes: [sample, torque], tasks }
    }
}

/// Frame lengths, and the tasks to encode and to decode.
fn tasks<C: Codec<V> + 'static, V: Copy + PartialEq + std::fmt::Debug + 'static>(
    values: &[V],
    extremes: &[V],
) -> (Length, [Box<dyn FnMut() -> f64>; 2]) {
    let (mut encoder, mut decoder) = (C::default(), C::default());
    let work = Rc::new(Work::new(&mut encoder, values, extremes));
    let bytes = work.bytes();
    let to_encode = Rc::clone(&work);
    (bytes, [Box::new(move || to_encode.encode(&mut encoder)), Box::new(move || work.decode(&mut decoder))])
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
pub fn measure(mut sides: Vec<Side>) -> Vec<Figures> {
    let mut times = vec![[const { Vec::new() }; TASKS]; sides.len()];
    for _ in 0..ROUNDS {
        for task in 0..TASKS {
            for (side, times) in sides.iter_mut().zip(&mut times) {
                times[task].push(side.tasks[task]());
            }
        }
    }
    let figures = sides.into_iter().zip(times).map(|(Side { name, checked, bytes, .. }, times)| Figures {
        name,
        checked,
        ns: times.map(median),
        bytes,
    });
    figures.collect()
}

pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
