//! What a fault of the power stage says of the current sensor.

use lashloop_bench::run::End;
use lashloop_identify::electrical::StageTrip;
use lashloop_protocol::enums::FaultCode;

/// Details of the fault, as the firmware counts them: the bench doesn't depend on a drive.
const OVERCURRENT: u32 = 4;
const CURRENT_SENSOR: u32 = 6;

pub(super) fn trip(end: &End) -> Option<StageTrip> {
    let End::DriveFault(fault) = end else { return None };
    match (fault.message.code, fault.message.detail) {
        (FaultCode::PowerStage, CURRENT_SENSOR) => Some(StageTrip::Sensor),
        (FaultCode::PowerStage, OVERCURRENT) => Some(StageTrip::Overcurrent),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use lashloop_firmware::power_stage::PowerStageFault;

    use super::*;

    #[test]
    fn the_details_are_those_of_the_firmware() {
        assert_eq!(OVERCURRENT, PowerStageFault::Overcurrent as u32);
        assert_eq!(CURRENT_SENSOR, PowerStageFault::CurrentSensor as u32);
    }
}
