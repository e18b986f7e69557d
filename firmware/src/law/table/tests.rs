//! What compiles as a set of laws, and what does not.

use super::*;

const GAIN: Parameter = Parameter::new("gain", "s", Range::F32 { default: 1.0, min: 0.0, max: 2.0 });
const LIMIT: Parameter = Parameter::new("limit_nm", "N m", Range::U32 { default: 3, min: 1, max: 4 });

#[test]
fn one_name_is_one_parameter_of_all_laws_that_declare_it() {
    let all = collect_parameters(&[&[LIMIT]], &[&[&[GAIN]], &[&[LIMIT], &[GAIN]], &[]]);
    let table: [Parameter; 2] = all.exact();
    assert_eq!((all.len, table[0].name, table[1].name), (2, "limit_nm", "gain"));
    // A parameter of the drive has the bits of all laws.
    assert_eq!((table[0].laws, table[1].laws), (0b111, 0b011));
    assert_eq!(map_parameters::<2>(&table, &[&[GAIN], &[LIMIT]]), [1, 0]);
    assert_eq!(defaults(&table), [3, 1.0_f32.to_bits()]);
}

#[test]
#[should_panic(expected = "gain is a parameter of bench mode, and one of a law")]
fn a_law_has_no_parameter_of_bench_mode() {
    check_appended(&[LIMIT, GAIN], &[GAIN]);
}

#[test]
#[should_panic(expected = "gain is declared twice, with different units, defaults or ranges")]
fn a_parameter_with_two_ranges_is_refused() {
    let wider = Parameter { range: Range::F32 { default: 1.0, min: 0.0, max: 3.0 }, ..GAIN };
    let _ = collect_parameters(&[], &[&[&[GAIN]], &[&[wider]]]);
}

#[test]
#[should_panic(expected = "gain has a default outside its range")]
fn a_default_outside_its_range_is_refused() {
    let _ = collect_parameters(
        &[&[Parameter { range: Range::F32 { default: 3.0, min: 0.0, max: 2.0 }, ..GAIN }]],
        &[],
    );
}

#[test]
#[should_panic(expected = "is longer than the 27 bytes of a parameter's name")]
fn a_name_that_does_not_fit_its_field_is_refused() {
    let _ = collect_parameters(&[&[Parameter { name: "a_name_of_twenty_eight_bytes", ..GAIN }]], &[]);
}

#[test]
#[should_panic(expected = "e_rad is a signal of the drive itself, or twice a signal of one law")]
fn a_signal_of_the_drive_is_no_signal_of_a_law() {
    let error = Signal::new("e_rad", "rad");
    let _ = collect_signals(&[&[error]], &[&[&[error]]]);
}

#[test]
#[should_panic(expected = "pd is the name of two laws")]
fn two_laws_of_one_name_are_refused() {
    let _ = controller(&["pd", "pd"]);
}

#[test]
#[should_panic(expected = "a parameter has an empty name")]
fn a_parameter_without_a_name_is_refused() {
    let _ = collect_parameters(&[&[Parameter { name: "", ..GAIN }]], &[]);
}

#[test]
#[should_panic(expected = "a signal has an empty name")]
fn a_signal_without_a_name_is_refused() {
    let _ = collect_signals(&[], &[&[&[Signal::new("", "rad")]]]);
}

#[test]
#[should_panic(expected = "a law has an empty name")]
fn a_law_without_a_name_is_refused() {
    let _ = controller(&["pd", ""]);
}

#[test]
#[should_panic(expected = "a choice has an empty name")]
fn a_choice_without_a_name_is_refused() {
    let _ = collect_parameters(&[&[source(&["model", ""])]], &[]);
}

#[test]
#[should_panic(expected = "model is the name of two choices of one parameter")]
fn two_choices_of_one_name_are_refused() {
    let _ = collect_parameters(&[&[source(&["model", "observed", "model"])]], &[]);
}

const fn source(names: &'static [&'static str]) -> Parameter {
    Parameter::new("source", "", Range::Choice { default: 0, names })
}

/// `limit_nm` of the drive, `gain` of two laws, `rate` of the second one; the names that each law takes live.
fn live(of_first: &'static [&'static str], of_second: &'static [&'static str]) -> [bool; 3] {
    let rate = Parameter { name: "rate", ..GAIN };
    let all = collect_parameters(&[&[LIMIT]], &[&[&[GAIN]], &[&[GAIN, rate]]]);
    mark_live::<3>(all.exact(), 1, &[of_first, of_second]).map(|parameter| parameter.live)
}

#[test]
fn a_parameter_is_live_if_every_law_that_has_it_takes_it_live() {
    assert_eq!(live(&[], &[]), [false; 3]);
    assert_eq!(live(&["gain"], &["rate"]), [false, false, true]);
    assert_eq!(live(&["gain"], &["gain"]), [false, true, false]);
}

#[test]
#[should_panic(expected = "limit_nm is a parameter of the drive itself, and a law takes it live")]
fn a_parameter_of_the_drive_is_not_live() {
    let _ = live(&["limit_nm"], &[]);
}

#[test]
#[should_panic(expected = "rate is taken live by a law that doesn't have it")]
fn a_law_takes_only_its_own_parameters_live() {
    let _ = live(&["rate"], &[]);
}
