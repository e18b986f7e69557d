//! A quantity that a motion doesn't excite has no value.

use lashloop_identify::excitation::{DriveTrain as _, Guard, PlannedMotion};
use lashloop_identify::{Direction, IdentifyError, Instruments, Series, Start, directions, identify};

use crate::hidden_plants::HiddenPlant;

/// A torque that swings within breakaway: the load stays at rest.
fn swing_of_the_motor(plant: &mut HiddenPlant) -> Series {
    let torque_nm = (0..2000).map(|at| 0.3 * (f64::from(at) * 0.004).sin()).collect();
    let motion = PlannedMotion { name: "swing".to_owned(), torque_nm, twist_rad: None, held: None };
    let guard = Guard::unlimited(&plant.instruments(), 1e-3);
    plant.make(&motion, guard).expect("a motion").expect("a plant at rest").series
}

#[test]
fn load_at_rest_shows_neither_inertia_nor_friction_nor_ratio() {
    let mut plant = HiddenPlant::draw(3);
    let series = swing_of_the_motor(&mut plant);
    let identified = identify(&[series], &plant.instruments(), &Start::default()).expect("the motor moves");
    assert_eq!(identified.directions.load, None);
    for name in ["reduction_ratio", "load_inertia_kg_m2", "load_friction_nm_s_rad", "load_coulomb_nm"] {
        let quantity = identified.quantity(name).expect(name);
        assert_eq!(quantity.estimate, None, "{name}");
    }
    for name in ["gap_width_rad", "stiffness_nm_rad", "motor_coulomb_nm"] {
        let estimate = identified.quantity(name).and_then(|it| it.estimate).expect(name);
        let truth = plant.truth(name);
        assert!((estimate.low..=estimate.high).contains(&truth), "{name}: {estimate:?}, truth {truth}");
    }
}

#[test]
fn motor_at_rest_shows_nothing() {
    let series = Series::new(1000, vec![0.001; 500], vec![7; 500], vec![-3; 500]).expect("a series");
    let instruments = Instruments::exact(4000, 4000, 1000);
    let error = identify(&[series], &instruments, &Start::default()).expect_err("nothing moves");
    assert_eq!(error, IdentifyError::MotorAtRest);
}

#[test]
fn reversed_wires_of_the_motor_encoder_are_its_direction_and_change_nothing_else() {
    let mut plant = HiddenPlant::draw(3);
    let series = swing_of_the_motor(&mut plant);
    let wired = |sign: i64| {
        let motor = series.motor_counts().iter().map(|count| sign * plant.signs[0] * count).collect();
        Series::new(1000, series.torque_nm().to_vec(), motor, series.load_counts().to_vec())
            .expect("a series")
    };
    let shown = [1, -1].map(|sign| directions(&[wired(sign)]).motor);
    assert_eq!(shown, [Some(Direction::Forward), Some(Direction::Reverse)]);
    let [forward, reverse] = [1, -1].map(|sign| {
        let start = Start::default();
        identify(&[wired(sign)], &plant.instruments(), &start).expect("the motor moves").quantities
    });
    assert_eq!(forward, reverse);
}
