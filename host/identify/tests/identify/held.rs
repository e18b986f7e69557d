//! A drive train that an offset of the torque moves.

use lashloop_identify::excitation::{Limits, commission};
use lashloop_identify::{Held, Series, SeriesError, Start};
use lashloop_plant::backlash_shaft::StribeckParameters;

use crate::hidden_plants::HiddenPlant;
use crate::hidden_plants::hidden::Errors;

const LIMITS: Limits =
    Limits { torque_nm: 20.0, motor_speed_rad_s: 400.0, load_speed_rad_s: 10.0, load_travel_rad: 1.5 };
const OFFSET_NM: f64 = 0.2;

/// A plant with this friction at the motor, half of it of the motor itself.
fn plant(friction_nm: f64) -> HiddenPlant {
    let mut plant =
        HiddenPlant::draw(7).with_errors(Errors { offset_nm: OFFSET_NM, ..Errors::default() }, [0.0; 2]);
    let friction =
        |nm: f64, of: StribeckParameters| StribeckParameters { coulomb_nm: nm, stiction_nm: 1.1 * nm, ..of };
    plant.shaft.motor = friction(0.5 * friction_nm, plant.shaft.motor);
    plant.shaft.load = friction(0.5 * friction_nm * plant.mechanics.ratio, plant.shaft.load);
    plant
}

#[test]
fn a_drive_train_that_its_offset_moves_is_held_and_estimated() {
    // Without a torque 0.1 N m are left to move it.
    let friction_nm = 0.1;
    let mut plant = plant(friction_nm);
    let instruments = plant.instruments();
    let found = commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
    let found = found.expect("estimates");
    assert!((found.held_nm + OFFSET_NM).abs() < friction_nm, "held at {} N m", found.held_nm);
    assert!(found.identified.is_followed(), "{:?}", found.identified.residual_counts);
    let offset = found.identified.quantity("torque_offset_nm").and_then(|it| it.estimate).expect("an offset");
    assert!((offset.value - OFFSET_NM).abs() < 0.002, "{offset:?}");
    let shown = [found.identified.directions.motor, found.identified.directions.load];
    assert_eq!(shown.map(|it| it.map(lashloop_identify::Direction::sign)), plant.signs.map(Some));
}

/// Such a load gains speed under the better of two torques too.
#[test]
fn a_load_without_friction_of_its_own_is_held_at_either_sign_of_the_offset() {
    for offset_nm in [OFFSET_NM, -OFFSET_NM] {
        let mut plant = plant(0.1);
        plant.mechanics.load_friction_nm_s_rad /= 20.0;
        plant.errors.offset_nm = offset_nm;
        let instruments = plant.instruments();
        let found = commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
        let held_nm = found.expect("estimates").held_nm;
        assert!((held_nm + offset_nm).abs() < 0.1, "held at {held_nm} N m");
    }
}

#[test]
fn a_drive_train_that_rests_is_not_held() {
    let mut plant = plant(1.0);
    let instruments = plant.instruments();
    let found = commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
    assert_eq!(found.expect("estimates").held_nm, 0.0);
}

/// A drive without a command gives no torque, so its offset moves the drive train from one motion to the next.
#[test]
fn what_an_offset_moves_between_the_motions_is_not_part_of_them() {
    let mut plant = plant(0.1);
    plant.between_s = 0.03;
    let instruments = plant.instruments();
    let found = commission(&mut plant, &instruments, &LIMITS, HiddenPlant::PERIOD_US, &Start::default());
    let found = found.expect("estimates");
    assert!((found.held_nm + OFFSET_NM).abs() < 0.1, "held at {} N m", found.held_nm);
    assert!(found.identified.is_followed(), "{:?}", found.identified.residual_counts);
    let offset = found.identified.quantity("torque_offset_nm").and_then(|it| it.estimate).expect("an offset");
    assert!((offset.value - OFFSET_NM).abs() < 0.002, "{offset:?}");
}

#[test]
fn a_held_series_begins_after_its_lead_in() {
    let torque_nm: Vec<f64> = (0..300).map(f64::from).collect();
    let counts: Vec<i64> = (0..300).collect();
    let series = Series::new(1000, torque_nm, counts.clone(), counts).expect("a series");
    let held = series.clone().held(Held { torque_nm: -0.2, lead_in_s: 0.1 }).expect("a series");
    assert_eq!((held.torque_nm()[0], held.motor_counts()[0], held.load_counts().len()), (100.0, 100, 200));
    let short = series.held(Held { torque_nm: -0.2, lead_in_s: 0.25 });
    assert_eq!(short, Err(SeriesError::Short { samples: 50 }));
}
