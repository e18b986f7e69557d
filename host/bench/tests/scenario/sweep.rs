//! `[sweep]`: one file, many cases.

use lashloop_bench::scenario::cases::Cases;
use lashloop_bench::scenario::{Override, Scenario, plant};

use crate::{SHORTEST, read, set};

fn cases(sweep: &str, overrides: &[Override]) -> Result<Cases, String> {
    Cases::from_str("x.toml", &format!("{SHORTEST}{sweep}"), overrides, &plant::standard())
        .map_err(|errors| errors.to_string())
}

fn good(sweep: &str) -> Cases {
    cases(sweep, &[]).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The settings of every case, as after `--set`.
fn names(cases: &Cases) -> Vec<String> {
    let name = |case: &Vec<_>| case.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    cases.settings().iter().map(name).collect()
}

fn scenarios(cases: &Cases) -> Vec<Scenario> {
    let read = |case: &Vec<_>| cases.scenario(case).unwrap_or_else(|errors| panic!("{errors}"));
    cases.settings().iter().map(read).collect()
}

const LAW_AND_GAP: &str = "[[sweep.axis]]\nkey = \"controller.name\"\nvalues = [\"pd\", \"merzouki\"]\n\
                           [[sweep.axis]]\nkey = \"plant.dead_zone_rad\"\n";

#[test]
fn a_scenario_without_a_sweep_is_one_case() {
    let cases = good("");
    assert_eq!(names(&cases), [""]);
    assert_eq!(scenarios(&cases), [read(SHORTEST, &[]).expect("a good scenario")]);
}

#[test]
fn a_grid_has_every_combination_and_varies_the_last_axis_fastest() {
    let cases = good(&format!("{LAW_AND_GAP}min = 0.1\nmax = 0.3\npoints = 3\n"));
    let gaps = ["0.1", "0.2", "0.3"].map(|gap| format!("plant.dead_zone_rad={gap}"));
    let both = |law: &str| gaps.clone().map(|gap| format!("controller.name={law} {gap}"));
    assert_eq!(names(&cases), [both("pd"), both("merzouki")].concat());
    let last = &scenarios(&cases)[5];
    assert_eq!((&*last.controller.name, last.plant.number("dead_zone_rad")), ("merzouki", Some(0.3)));
}

#[test]
fn a_list_takes_the_values_of_all_axes_together() {
    let list = "[sweep]\nmethod = \"list\"\n";
    let cases = good(&format!("{list}{LAW_AND_GAP}values = [0.1, 0.3]\n"));
    let want =
        ["controller.name=pd plant.dead_zone_rad=0.1", "controller.name=merzouki plant.dead_zone_rad=0.3"];
    assert_eq!(names(&cases), want);
}

#[test]
fn seeds_repeat_every_point() {
    let cases = good("[sweep]\nseeds = 2\n[[sweep.axis]]\nkey = \"run.duration_s\"\nvalues = [1, 2.5]\n");
    let runs: Vec<_> =
        scenarios(&cases).iter().map(|scenario| (scenario.run.duration_s, scenario.run.seed)).collect();
    assert_eq!(runs, [(1.0, 1), (1.0, 2), (2.5, 1), (2.5, 2)]);
}

#[test]
fn points_are_spaced_by_the_scale() {
    let spaced = |scale: &str| {
        let axis =
            "[[sweep.axis]]\nkey = \"encoders.load_counts_per_rev\"\nmin = 100\nmax = 10000\npoints = 3\n";
        names(&good(&format!("{axis}scale = \"{scale}\"\n")))
            .iter()
            .map(|name| name.rsplit_once('=').expect("a setting").1.to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(spaced("linear"), ["100", "5050", "1e4"]);
    assert_eq!(spaced("logarithmic"), ["100", "1000", "1e4"]);
    assert_eq!(spaced("whole"), ["100", "5050", "10000"]);
}

#[test]
fn a_latin_hypercube_is_a_function_of_its_seed() {
    let cube = |seed: u32, points: u32| {
        good(&format!(
            "[sweep]\nmethod = \"latin-hypercube\"\npoints = {points}\nsampling_seed = {seed}\n\
             [[sweep.axis]]\nkey = \"plant.dead_zone_rad\"\nmin = 0.1\nmax = 0.3\n\
             [[sweep.axis]]\nkey = \"encoders.load_counts_per_rev\"\nmin = 1000\nmax = 8000\nscale = \"whole\"\n"
        ))
    };
    assert_eq!(names(&cube(1, 20)), names(&cube(1, 20)));
    assert_ne!(names(&cube(1, 20)), names(&cube(2, 20)));
    let mut gaps: Vec<_> = scenarios(&cube(1, 20))
        .iter()
        .map(|scenario| scenario.plant.number("dead_zone_rad").expect("a gap"))
        .collect();
    gaps.sort_by(f64::total_cmp);
    for (stratum, gap) in gaps.iter().enumerate() {
        let low = 0.1 + 0.01 * stratum as f64;
        // Rounded to six digits.
        assert!((low - 1e-6..low + 0.01 + 1e-6).contains(gap), "{gap} is not in stratum {stratum}");
    }
}

#[test]
fn every_error_of_a_sweep_names_its_line() {
    let axis = "[[sweep.axis]]\nkey = \"plant.dead_zone_rad\"\n";
    for (sweep, want) in [
        ("[sweep]\n".to_owned(), "x.toml:11: sweep: this section varies nothing; add [[sweep.axis]] or seeds"),
        ("[sweep]\nseeds = 20000\n".to_owned(), "x.toml:12: sweep.seeds: 20000 is out of range; it must be >= 1 and <= 10000"),
        (axis.to_owned(), "x.toml:11: sweep.axis.0: this section must give either values, or both min and max"),
        (format!("{axis}min = 0.1\nmax = 0.2\n"), "x.toml:11: sweep.axis.0: this section has a range without points; add points"),
        (format!("{axis}min = 0.3\nmax = 0.2\npoints = 3\n"), "x.toml:14: sweep.axis.0.max: 0.2 isn't an upper end; it must be > 0.3"),
        (format!("{axis}values = []\n"), "x.toml:13: sweep.axis.0.values: [0 items] is a list; it must be a list of numbers, booleans or texts"),
        (format!("{axis}min = 0.0\nmax = 0.2\npoints = 3\nscale = \"logarithmic\"\n"), "x.toml:13: sweep.axis.0.min: 0.0 has no logarithm; it must be > 0"),
        (format!("{axis}values = [0.1]\n{axis}values = [0.2]\n"), "has two axes of plant.dead_zone_rad; each key has one"),
        ("[sweep]\nmethod = \"latin-hypercube\"\n[[sweep.axis]]\nkey = \"run.duration_s\"\nmin = 1\nmax = 2\n".to_owned(), "x.toml:11: sweep: this section is a Latin hypercube without points; add points"),
        (format!("[sweep]\nmethod = \"list\"\n{LAW_AND_GAP}values = [0.1]\n"), "x.toml:11: sweep: this section is a list whose axes have 2, 1 values; all must have the same number"),
        (format!("[sweep]\nseeds = 9\n{LAW_AND_GAP}min = 0.1\nmax = 0.3\npoints = 900\n"), "x.toml:11: sweep: this section has 16200 cases; at most 10000 are allowed"),
    ] {
        let error = cases(&sweep, &[]).map(drop).expect_err("a faulty sweep");
        assert!(error.contains(want), "{sweep}\nis {error}\nnot {want}");
    }
}

#[test]
fn a_value_that_the_key_refuses_names_axis_and_value() {
    let cases = good("[[sweep.axis]]\nkey = \"plant.dead_zone_rad\"\nvalues = [0.1, -1.0]\n");
    let [good, bad] = cases.settings() else { panic!("two cases") };
    assert!(cases.scenario(good).is_ok());
    let errors = cases.scenario(bad).expect_err("a negative gap");
    let error = errors.iter().next().expect("an error");
    let text = error.to_string();
    assert!(
        text.starts_with(
            "x.toml:12: [sweep] plant.dead_zone_rad=-1: plant.dead_zone_rad: -1.0 is out of range"
        ),
        "{text}"
    );
    assert_eq!(error.place(), Some(("x.toml".to_owned(), 12, 1)));
}

#[test]
fn a_run_refuses_a_sweep_and_names_the_command_for_it() {
    let swept = format!("{SHORTEST}{LAW_AND_GAP}values = [0.1, 0.2]\n");
    let error = read(&swept, &[]).expect_err("a sweep");
    assert!(error.starts_with("x.toml:11: sweep: 4 cases of a sweep are run by `lashloop test`"), "{error}");
}

#[test]
fn an_option_and_a_sweep_of_one_key_contradict_each_other() {
    let sweep = "[[sweep.axis]]\nkey = \"plant.dead_zone_rad\"\nvalues = [0.1]\n";
    let error = cases(sweep, &set(["plant.dead_zone_rad=0.2"])).map(drop).expect_err("a contradiction");
    assert!(error.contains("--set plant.dead_zone_rad=0.2 sets a key that [sweep] varies"), "{error}");
}
