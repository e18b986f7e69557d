//! From the number of a case to its values.

use lashloop_bench::scenario::Override;
use lashloop_campaign::Campaign;
use lashloop_campaign::cell::CaseNumbers as _;
use lashloop_campaign::file::Divisor;

use crate::support::{campaign, read};

fn values(campaign: &Campaign, part: usize) -> Vec<Vec<f64>> {
    let cases = (0..campaign.plan.cases()).map(|case| campaign.case(case).expect("a case"));
    let mine = cases.filter(|case| case.part == part && case.variant == 0);
    mine.map(|case| case.values.iter().map(|value| value.number().expect("a number")).collect()).collect()
}

#[test]
fn cases_are_in_the_order_of_parts_rows_and_variants() {
    let campaign = campaign();
    assert_eq!(campaign.plan.cases(), 2 * (11 + 6));
    let places: Vec<_> = (0..34).map(|case| campaign.plan.place(case)).collect();
    assert!(places.is_sorted());
    assert_eq!([places[0], places[1], places[22]], [(0, 0, 0), (0, 0, 1), (1, 0, 0)]);
    let grid = values(&campaign, 1);
    let want = [[0.0, 0.1], [0.0, 0.15], [0.0, 0.2], [1000.0, 0.1], [1000.0, 0.15], [1000.0, 0.2]];
    for (have, want) in grid.iter().zip(want) {
        assert!(have.iter().zip(want).all(|(have, want)| (have - want).abs() < 1e-12), "{grid:?}");
    }
    let error = campaign.case(34).expect_err("beyond the last");
    assert_eq!(error.to_string(), "there is no case 34; the campaign has cases 0 to 33");
}

#[test]
fn each_stratum_of_a_latin_hypercube_and_of_a_sobol_sequence_has_one_point() {
    for method in ["latin-hypercube", "sobol"] {
        let axes = ["plant.dead_zone_rad", "plant.stiffness_nm_rad", "plant.load_inertia_kg_m2"];
        let axes: String = axes
            .iter()
            .map(|key| format!("[[part.axis]]\nkey = \"{key}\"\nmin = 0.1\nmax = 0.2\n"))
            .collect();
        let part = format!("[[part]]\nname = \"all\"\nmethod = \"{method}\"\npoints = 64\n{axes}");
        let points = values(&read(&part).expect("a campaign"), 0);
        for axis in 0..3 {
            let stratum = |point: &Vec<f64>| ((point[axis] - 0.1) / 0.1 * 64.0) as u32;
            let mut strata: Vec<_> = points.iter().map(stratum).collect();
            assert!(!strata.is_sorted(), "{method}: axis {axis} is in order");
            strata.sort_unstable();
            assert_eq!(strata, (0..64).collect::<Vec<_>>(), "{method}: axis {axis}");
        }
    }
}

#[test]
fn a_value_is_multiplied_by_that_of_the_scenario_or_of_an_earlier_axis() {
    let part = "[[part]]\nname = \"all\"\nmethod = \"list\"\n\
                [[part.axis]]\nkey = \"plant.load_coulomb_nm\"\nvalues = [0.5, 2]\ntimes = \"plant.load_coulomb_nm\"\n\
                [[part.axis]]\nkey = \"plant.load_stiction_nm\"\nvalues = [1, 3]\ntimes = \"plant.load_coulomb_nm\"\n";
    let campaign = read(part).expect("a campaign");
    let nominal = campaign.scenario(&campaign.plan.case(0)).expect("a scenario");
    let coulomb = nominal.plant.number("load_coulomb_nm").expect("a number") / 0.5;
    let points = values(&campaign, 0);
    assert_eq!(points, [[0.5 * coulomb, 0.5 * coulomb], [2.0 * coulomb, 6.0 * coulomb]]);
}

#[test]
fn a_case_sets_all_keys_of_an_axis_on_top_of_its_variant() {
    let campaign = campaign();
    let case = campaign.case(23).expect("a case");
    let set = |text: &str| Override::Set(text.to_owned());
    let want =
        ["meant=mismatch", "plant.stiffness_nm_rad=2", "plant.torque_delay_us=0", "plant.dead_zone_rad=0.1"];
    assert_eq!(campaign.overrides(&case), want.map(set));
    let scenario = campaign.scenario(&case).expect("a scenario");
    assert_eq!(scenario.plant.number("stiffness_nm_rad"), Some(2.0));
}

#[test]
fn a_part_sets_values_and_a_variant_omits_keys_it_lacks() {
    let parts = "[[variant]]\nname = \"all\"\n\
                 [[variant]]\nname = \"lacks\"\nomit = [\"plant.load_inertia_kg_m2\"]\n\
                 [[part]]\nname = \"one\"\nmethod = \"list\"\nset = [\"encoders.load_counts_per_rev=500\"]\n\
                 [[part.axis]]\nkeys = [\"plant.load_friction_nm_s_rad\", \"plant.load_inertia_kg_m2\"]\nvalues = [3]\n";
    let campaign = read(parts).expect("a campaign");
    let cases = [0, 1].map(|number| campaign.case(number).expect("a case"));
    let [all, lacks] = cases.each_ref().map(|case| {
        let scenario = campaign.scenario(case).expect("a scenario");
        assert_eq!(scenario.encoders.load_counts_per_rev, 500);
        assert_eq!(campaign.number(case, "encoders.load_counts_per_rev"), Some(500.0));
        let number = |key| scenario.plant.number(key).expect("a number");
        let inertia = number("load_inertia_kg_m2");
        assert_eq!(campaign.number(case, "plant.load_inertia_kg_m2"), Some(inertia));
        [number("load_friction_nm_s_rad"), inertia]
    });
    assert_eq!((all, lacks), ([3.0, 3.0], [3.0, 7.5]));
}

#[test]
fn the_minimum_settling_time_is_that_of_the_case_s_own_plant() {
    let minimum_s = |set: &str| {
        let part = format!(
            "[[part]]\nname = \"one\"\nmethod = \"list\"\nset = [{set}]\n\
             [[part.axis]]\nkey = \"plant.torque_saturation_nm\"\nvalues = [10]\n"
        );
        let campaign = read(&part).expect("a campaign");
        let case = campaign.case(0).expect("a case");
        (&campaign, &case).quantity(Divisor::MinimumSettleTime)
    };
    // benchmarks/minimum-time: 1.382 s at 10 N m, with a delay of 1 ms.
    assert!((minimum_s("").expect("a minimum") / 1.382 - 1.0).abs() < 0.02, "{:?}", minimum_s(""));
    let later = minimum_s("\"plant.torque_delay_us=101000\"").expect("a minimum");
    assert!((later - minimum_s("").expect("a minimum") - 0.1).abs() < 1e-12);
    for without in [
        "\"plant.load_torque.torque_nm=1\"",
        "\"plant.initial.load_velocity_rad_s=1\"",
        "'meant=\"start\"', \"reference={ profile='step', before_rad=0, after_rad=1, at_s=1 }\"",
    ] {
        assert_eq!(minimum_s(without), None, "{without}");
    }
}
