//! MAVLink 2 as simulators use it: `HIL_SENSOR` to the autopilot, `HIL_ACTUATOR_CONTROLS` back. Our values take the fields that
//! fit best; the other fields hold typical values of a flight.

use ::mavlink::dialects::common::{
    HIL_ACTUATOR_CONTROLS_DATA, HIL_SENSOR_DATA, HilActuatorControlsFlags, HilSensorUpdatedFlags, MavMessage,
    MavModeFlag,
};
use ::mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message};

use super::Codec;
use crate::cycle::{Sample, Torque};

pub struct Mavlink {
    sent: MAVLinkV2MessageRaw,
    received: MAVLinkV2MessageRaw,
}

impl Default for Mavlink {
    fn default() -> Self {
        Self { sent: MAVLinkV2MessageRaw::new(), received: MAVLinkV2MessageRaw::new() }
    }
}

impl Mavlink {
    fn send(&mut self, sequence: u16, message: &MavMessage, send: impl FnOnce(&[u8])) {
        let header = MavHeader { system_id: 1, component_id: 1, sequence: sequence as u8 };
        self.sent.serialize_message(header, message);
        send(self.sent.raw_bytes());
    }

    fn open(&mut self, frame: &[u8]) -> MavMessage {
        let received = &mut self.received;
        received.as_mut_slice()[..frame.len()].copy_from_slice(frame);
        assert!(received.has_valid_crc::<MavMessage>());
        MavMessage::parse(MavlinkVersion::V2, received.message_id(), received.payload()).expect("a message")
    }
}

impl Codec<Sample> for Mavlink {
    fn encode(&mut self, value: &Sample, send: impl FnOnce(&[u8])) {
        let data = HIL_SENSOR_DATA {
            time_usec: value.sequence.into(),
            // A float holds counts of 24 bits exactly.
            xacc: value.motor_counts as f32,
            yacc: value.load_counts as f32,
            zacc: value.reference_rad,
            xgyro: 0.01,
            ygyro: 0.02,
            zgyro: 0.03,
            xmag: 0.21,
            ymag: 0.01,
            zmag: 0.43,
            abs_pressure: 955.98,
            diff_pressure: 0.1,
            pressure_alt: 488.1,
            temperature: 20.5,
            fields_updated: HilSensorUpdatedFlags::all(),
        };
        self.send(value.sequence, &MavMessage::HIL_SENSOR(data), send);
    }

    fn decode(&mut self, frame: &[u8]) -> Sample {
        let MavMessage::HIL_SENSOR(data) = self.open(frame) else { panic!("no sample") };
        Sample {
            sequence: data.time_usec as u16,
            motor_counts: data.xacc as i32,
            load_counts: data.yacc as i32,
            reference_rad: data.zacc,
        }
    }
}

impl Codec<Torque> for Mavlink {
    fn encode(&mut self, value: &Torque, send: impl FnOnce(&[u8])) {
        let mut data = HIL_ACTUATOR_CONTROLS_DATA {
            time_usec: value.sequence.into(),
            controls: [0.0; 16],
            mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
            flags: HilActuatorControlsFlags::HIL_ACTUATOR_CONTROLS_FLAGS_LOCKSTEP,
        };
        data.controls[..4].copy_from_slice(&[
            value.torque_nm,
            value.state.into(),
            value.flags.into(),
            value.compute_tenths_us.into(),
        ]);
        self.send(value.sequence, &MavMessage::HIL_ACTUATOR_CONTROLS(data), send);
    }

    fn decode(&mut self, frame: &[u8]) -> Torque {
        let MavMessage::HIL_ACTUATOR_CONTROLS(data) = self.open(frame) else { panic!("no torque") };
        Torque {
            sequence: data.time_usec as u16,
            torque_nm: data.controls[0],
            state: data.controls[1] as u8,
            flags: data.controls[2] as u8,
            compute_tenths_us: data.controls[3] as u16,
        }
    }
}
