use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::plant::standard;

use super::*;

fn selected(seed: u64, points: u64) -> Campaign {
    let parts = vec![RANDOM_PLANTS.to_owned()];
    let selection = Selection { seed: Some(seed), points: Some(points), parts, ..Selection::default() };
    Battery::Standard.campaign(selection, &standard()).expect("the campaign")
}

fn settings(campaign: &Campaign, case: u64) -> Vec<String> {
    let case = campaign.case(case).expect("a case");
    campaign.overrides(&case).iter().map(ToString::to_string).collect()
}

#[test]
fn laws_are_those_of_the_campaign() {
    assert_eq!(parse_law("merzouki").as_deref(), Ok("merzouki"));
    let expected = "expected pd, merzouki, backlash-inverse or braking-curve";
    assert_eq!(parse_law("lqr"), Err(expected.to_owned()));
}

/// Other numbers would change every published table.
#[test]
fn plant_of_a_seed_is_pinned() {
    let want = "--set meant=mismatch --set plant.load_inertia_kg_m2=8.95828860515543 \
                --set plant.load_friction_nm_s_rad=19.350432193719477 \
                --set plant.motor_inertia_kg_m2=0.0008630273775968695 \
                --set plant.motor_friction_nm_s_rad=0.0005057293237257785 \
                --set plant.stiffness_nm_rad=0.714793523289864 \
                --set plant.shaft_damping_nm_s_rad=0.0032310173959924976 \
                --set plant.load_coulomb_nm=3.6808011566737804 \
                --set plant.load_stribeck_rad_s=0.023632991198625716 \
                --set plant.motor_coulomb_nm=0.02284900012282 \
                --set plant.motor_stribeck_rad_s=0.15122572057585662 \
                --set plant.current_lag_ms=0.4071872448633933 --set plant.dead_zone_rad=0.10371509208480838 \
                --set plant.load_stiction_nm=4.24840340027415 --set plant.motor_stiction_nm=0.024064037863420686 \
                --set encoders.motor_counts_per_rev=5896 --set encoders.load_counts_per_rev=5896";
    assert_eq!(settings(&selected(1, 200), 0).join(" "), want);
}

#[test]
fn a_law_s_scenario_is_that_law_s_and_the_drive_s_parameters_stay() {
    let campaign = selected(1, 1);
    for number in 0..4 {
        let case = campaign.case(number).expect("a case");
        let scenario = campaign.scenario(&case).expect("a scenario");
        assert_eq!(scenario.controller.name, campaign.variants[case.variant].name);
        let source = campaign.scenario_source(&case);
        let nominal = Scenario::from_str(&source.path, &source.text, &[]).expect("the law's scenario");
        assert_eq!(scenario.controller, nominal.controller);
        assert_ne!(scenario.plant, nominal.plant);
    }
}

#[test]
fn fewer_plants_are_the_first_of_more() {
    let (few, many) = (selected(3, 3), selected(3, 5));
    assert_eq!((few.plan.cases(), many.plan.cases()), (12, 20));
    for case in 0..12 {
        assert_eq!(settings(&few, case), settings(&many, case));
    }
}

#[test]
fn plants_fill_their_ranges_and_do_not_leave_them() {
    let campaign = selected(1, 2000);
    let axes = &campaign.file.parts[0].axes;
    let plants: Vec<_> = (0..2000).map(|row| campaign.case(4 * row).expect("a case")).collect();
    for (at, axis) in axes.iter().enumerate() {
        let lashloop_campaign::axis::Values::Range(range) = &axis.values else {
            panic!("{} has no range", axis.name())
        };
        let fraction = |case: &lashloop_campaign::plan::Case| {
            let value = case.values[at].number().expect("a number");
            let factor =
                axis.times.as_ref().map_or(1.0, |key| match axes.iter().position(|it| it.name() == key) {
                    // Stiction is relative to the Coulomb friction of the same plant.
                    Some(other) if other != at => case.values[other].number().expect("a number"),
                    _ => nominal(&campaign, key),
                });
            (value / factor - range.min) / (range.max - range.min)
        };
        let fractions: Vec<_> = plants.iter().map(fraction).collect();
        let (name, count) = (axis.name(), fractions.len() as f64);
        assert!(fractions.iter().all(|fraction| (-1e-12..=1.0 + 1e-12).contains(fraction)), "{name}");
        let mean = fractions.iter().sum::<f64>() / count;
        assert!((mean - 0.5).abs() < 0.03, "{name}: mean at {mean} of the range, want 0.5");
        let low = fractions.iter().copied().fold(f64::MAX, f64::min);
        let high = fractions.iter().copied().fold(f64::MIN, f64::max);
        assert!(low < 0.01 && high > 0.99, "{name}: from {low} to {high} of the range");
    }
}

/// The number of the nominal plant.
fn nominal(campaign: &Campaign, key: &str) -> f64 {
    let source = &campaign.sources[1];
    let scenario = Scenario::from_str(&source.path, &source.text, &[]).expect("a scenario");
    scenario.plant.number(key.strip_prefix("plant.").expect("a key of the plant")).expect("a number")
}

#[test]
fn the_harder_battery_has_the_plants_of_the_standard_one() {
    let standard = Battery::Standard.file().expect("a file").parts.swap_remove(0);
    let hard = Battery::Hard.file().expect("a file");
    let plants_of = |name: &str| hard.parts.iter().find(|part| part.name == name).expect("a part");
    assert_eq!(plants_of("alternating-moves").axes, standard.axes);
    for name in ["random-hard", "alternating-moves-hard", "random-lugre"] {
        assert_eq!(plants_of(name).axes[..standard.axes.len()], standard.axes, "{name}");
    }
}

#[test]
fn the_harder_battery_tells_each_law_what_it_can_take() {
    let laws = laws().expect("laws");
    let hard = Battery::Hard.file().expect("a file");
    assert_eq!(
        hard.variants.iter().map(|variant| &variant.name).collect::<Vec<_>>(),
        laws.iter().collect::<Vec<_>>()
    );
    let known = Selection { parts: vec!["load-known".to_owned()], ..Selection::default() };
    let campaign = Battery::Hard.campaign(known, &standard()).expect("the campaign");
    for (variant, law) in laws.iter().enumerate() {
        let case = campaign.first_case(0, variant);
        let set = campaign.scenario(&case).expect("a scenario").controller.parameters;
        let has = |name: &str| set.iter().any(|setting| setting.name == name);
        assert_eq!(
            (has("load_inertia_kg_m2"), has("load_coulomb_nm")),
            (true, law == "braking-curve"),
            "{law}"
        );
    }
}
