//! No motion goes beyond the limits that the user confirmed.

use lashloop_identify::Start;
use lashloop_identify::excitation::{CommissioningError, Limits, commission};

use crate::hidden_plants::HiddenPlant;

const WIDE: Limits =
    Limits { torque_nm: 20.0, motor_speed_rad_s: 400.0, load_speed_rad_s: 10.0, load_travel_rad: 1.5 };

fn error(limits: Limits) -> CommissioningError<lashloop_identify::SeriesError> {
    let mut plant = HiddenPlant::draw(3);
    let instruments = plant.instruments();
    commission(&mut plant, &instruments, &limits, HiddenPlant::PERIOD_US, &Start::default())
        .expect_err("a limit in the way")
}

#[test]
fn speed_beyond_its_limit_ends_the_commissioning() {
    let error = error(Limits { motor_speed_rad_s: 2.0, ..WIDE });
    assert!(
        matches!(&error, CommissioningError::Exceeded { exceeded, .. } if exceeded.quantity == "motor speed" && exceeded.value > 2.0),
        "{error}"
    );
}

#[test]
fn travel_beyond_its_limit_ends_the_commissioning() {
    let error = error(Limits { load_travel_rad: 0.003, ..WIDE });
    assert!(
        matches!(&error, CommissioningError::Exceeded { exceeded, .. } if exceeded.quantity == "load travel"),
        "{error}"
    );
}

#[test]
fn load_that_does_not_move_is_reported_with_the_torque() {
    let error = error(Limits { torque_nm: 0.2, ..WIDE });
    assert!(
        matches!(error, CommissioningError::NoBreakaway { torque_nm: 0.2, motor_counts, .. } if motor_counts > 3),
        "{error}"
    );
}

#[test]
fn no_planned_torque_exceeds_the_torque_limit() {
    /// Notes the largest torque of all motions.
    struct Watched(HiddenPlant, f64);

    impl lashloop_identify::excitation::DriveTrain for Watched {
        type Error = lashloop_identify::SeriesError;

        fn make(
            &mut self,
            motion: &lashloop_identify::excitation::PlannedMotion,
            guard: lashloop_identify::excitation::Guard,
        ) -> Result<Option<lashloop_identify::excitation::Made>, Self::Error> {
            self.1 = motion.torque_nm.iter().fold(self.1, |most, it| most.max(it.abs()));
            self.0.make(motion, guard)
        }
    }

    let plant = HiddenPlant::draw(3);
    let instruments = plant.instruments();
    let mut watched = Watched(plant, 0.0);
    let limits = Limits { torque_nm: 4.5, ..WIDE };
    commission(&mut watched, &instruments, &limits, HiddenPlant::PERIOD_US, &Start::default())
        .expect("enough to move the load");
    assert!(watched.1 <= 4.5, "largest torque {} N m", watched.1);
}
