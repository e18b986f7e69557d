//! postcard (serde, variable-length integers) with framing of our own. The CRC flavour of postcard processes single bytes, so we
//! use the wide tables and the `cobs` crate, which is faster.

use ::postcard::{from_bytes, to_slice};
use serde::{Deserialize, Serialize};

use super::Codec;
use super::framing::Framing;
use crate::cycle::{Sample, Torque};

#[derive(Serialize, Deserialize)]
enum Host {
    Sample { sequence: u16, motor_counts: i32, load_counts: i32, reference_rad: f32 },
    Stop,
}

#[derive(Serialize, Deserialize)]
enum Drive {
    Torque { sequence: u16, torque_nm: f32, state: u8, flags: u8, compute_tenths_us: u16 },
    Stopped,
}

#[derive(Default)]
pub struct Postcard(Framing<true>);

impl Postcard {
    fn send(&mut self, message: &impl Serialize, send: impl FnOnce(&[u8])) {
        self.0.send(|buffer| to_slice(message, buffer).expect("a large enough buffer").len(), send);
    }

    fn open<'a, M: Deserialize<'a>>(&'a mut self, frame: &[u8]) -> M {
        from_bytes(self.0.open(frame)).expect("a message")
    }
}

impl Codec<Sample> for Postcard {
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let Sample { sequence, motor_counts, load_counts, reference_rad } = *value;
        self.send(&Host::Sample { sequence, motor_counts, load_counts, reference_rad }, send);
    }

    fn decode(&mut self, frame: &[u8]) -> Sample {
        let Host::Sample { sequence, motor_counts, load_counts, reference_rad } = self.open(frame) else {
            panic!("no sample")
        };
        Sample { sequence, motor_counts, load_counts, reference_rad }
    }
}

impl Codec<Torque> for Postcard {
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let Torque { sequence, torque_nm, state, flags, compute_tenths_us } = *value;
        self.send(&Drive::Torque { sequence, torque_nm, state, flags, compute_tenths_us }, send);
    }

    fn decode(&mut self, frame: &[u8]) -> Torque {
        let Drive::Torque { sequence, torque_nm, state, flags, compute_tenths_us } = self.open(frame) else {
            panic!("no torque")
        };
        Torque { sequence, torque_nm, state, flags, compute_tenths_us }
    }
}
