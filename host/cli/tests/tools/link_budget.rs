//! The map of delay, jitter and loss: its campaign, the copy in the program, its page, and points on it.

use std::fs;

use lashloop::Bench;
use lashloop_campaign::budget::line_map::{Border, LineMap, MapError};
use lashloop_campaign::budget::placement::Placement;
use lashloop_campaign::budget::point::Point;
use lashloop_campaign::map::PlaceError;

use crate::support::{lashloop, root, text};

const CAMPAIGN: &str = "campaigns/link-budget.toml";

fn path(name: &str) -> String {
    root().join(name).to_str().expect("a path of ASCII").to_owned()
}

fn shipped() -> LineMap {
    LineMap::shipped().expect("a map")
}

/// Every 97th case, so that delays, jitters, losses and laws are mixed.
#[test]
fn map_in_the_program_is_that_of_its_campaign_with_any_number_of_jobs() {
    let shard = |jobs| {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().to_str().expect("a path of ASCII");
        let ended = lashloop(
            &["campaign", "run", &path(CAMPAIGN), "--shard", "9/97", "--jobs", jobs, "--out", out],
            &[],
        );
        assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
        fs::read_to_string(folder.path().join("shard-9-of-97.csv")).expect("rows")
    };
    let rows = shard("1");
    assert_eq!(rows, shard("2"));
    let shipped = fs::read_to_string(path("campaigns/link-budget.csv")).expect("a table");
    let mut compared = 0;
    // The header is in the first shard only.
    for row in rows.lines().filter(|row| !row.starts_with("case")) {
        let fields: Vec<_> = row.split(',').collect();
        let (case, settle_time_s) = (fields[0], fields[7]);
        assert!(
            shipped.lines().any(|line| line == format!("{case},{settle_time_s}")),
            "case {case} now has {settle_time_s}: the head of {CAMPAIGN} has the command for the table"
        );
        compared += 1;
    }
    assert_eq!(compared, 8);
}

#[test]
fn page_has_the_map_of_the_program() {
    let page = fs::read_to_string(path("docs/link-budget.md")).expect("a page");
    let map = shipped().to_string();
    assert!(page.contains(&format!("```text\n{map}\n```")), "the page lacks this map:\n{map}");
}

#[test]
fn border_is_where_the_interpolated_value_meets_the_limit() {
    let map = shipped();
    let [merzouki, braking_curve] = &map.variants[..] else { panic!("{map}") };
    let at = |delay_us, jitter_us, loss| Point { delay_us, jitter_us, loss };
    let [delay, jitter, _] = merzouki.borders(at(1000.0, 0.0, 0.0)).expect("borders");
    for point in [delay, jitter].map(|border| match border {
        Border::At(value) if border == delay => at(value, 0.0, 0.0),
        Border::At(value) => at(1000.0, value, 0.0),
        Border::Edge(edge) => panic!("inside up to {edge}"),
    }) {
        let value = merzouki.place(point).expect("on the map").value.value().expect("a number");
        assert!((value - merzouki.limit.value()).abs() < 0.01, "{value} s at {point:?}");
    }
    // At zero delay the load settles with any loss of the map.
    let borders = braking_curve.borders(at(0.0, 0.0, 0.0)).expect("borders");
    assert_eq!(borders[2], Border::Edge(0.8));
    // Downwards from a point outside the same border is found.
    let outside = merzouki.longest_delay_us(at(16_000.0, 0.0, 0.0)).expect("on the map");
    let Border::At(border) = delay else { panic!("{delay:?}") };
    assert!(outside.is_some_and(|outside| (outside - border).abs() < 2.0), "{outside:?}, {border}");
    assert_eq!(merzouki.longest_delay_us(at(24_000.0, 16_000.0, 0.0)), Ok(None));
}

#[test]
fn line_with_a_latency_timer_of_16_ms_is_outside_and_of_1_ms_inside() {
    let map = shipped();
    let placed = |delay_us, jitter_us| {
        Placement::new(&map, Point { delay_us, jitter_us, loss: 0.0 }).expect("on the map")
    };
    let (slow, fast) = (placed(16_020.0, 900.0), placed(1_400.0, 900.0));
    assert!(!slow.is_inside(Some("merzouki")) && !slow.is_inside(None));
    assert!(!slow.is_inside(Some("braking-curve")));
    assert!(fast.is_inside(None));
    insta::assert_snapshot!(format!("{slow}\n\n{fast}"), @r"
    point          delay 16020 us, jitter 900 us, loss 0
    map            campaigns/link-budget.toml: settle_time_s over delay, jitter and loss
    merzouki       OUTSIDE  cut short, limit 7 s; inside up to a delay of 5000 us at this jitter and loss
    braking-curve  OUTSIDE  cut short, limit 1.5 s; inside up to a delay of 12000 us at this jitter and loss

    point          delay 1400 us, jitter 900 us, loss 0
    map            campaigns/link-budget.toml: settle_time_s over delay, jitter and loss
    merzouki       inside   5.8861 s, limit 7 s; margin delay +3600 us, jitter +3100 us, loss +0.71
    braking-curve  inside   1.1771 s, limit 1.5 s; margin delay +10600 us, jitter +7100 us, loss +0.80 or more
    ");
}

#[test]
fn line_beyond_the_map_is_an_error_that_names_the_axis_and_its_range() {
    let map = shipped();
    let error = Placement::new(&map, Point { delay_us: 30_000.0, jitter_us: 0.0, loss: 0.0 });
    let error = MapError::from(error.expect_err("beyond the map"));
    let want = "the line is beyond the map: delay of 30000 us is outside the map, 0 to 24000 us; extend the axis of the \
                campaign";
    assert_eq!(error.to_string(), want);
    assert!(matches!(error, MapError::Beyond(PlaceError::Beyond { .. })));
}

#[test]
fn scenario_of_another_law_plant_or_period_has_no_place_on_the_map() {
    let map = shipped();
    let error = |name: &str, settings: &[&str]| {
        let scenario = Bench::new().scenario(path(name), settings).expect("a scenario");
        map.of_law(&scenario).map(|variant| variant.name.clone()).map_err(|error| error.to_string())
    };
    assert_eq!(error("scenarios/shaft-merzouki.toml", &[]), Ok("merzouki".to_owned()));
    let difference = |settings: &[&str]| {
        let scenario =
            Bench::new().scenario(path("scenarios/shaft-merzouki.toml"), settings).expect("a scenario");
        map.of_law(&scenario).expect("a law").difference(&scenario)
    };
    assert_eq!(difference(&[]), None);
    let heavy =
        difference(&["plant.load_inertia_kg_m2=15", "encoders.load_counts_per_rev=2000", "meant=mismatch"]);
    assert_eq!(heavy.as_deref(), Some("plant.load_inertia_kg_m2 is 15.0, 7.5 on the map"));
    for (name, settings, want) in [
        ("scenarios/shaft-pd.toml", &[][..], "has no law pd, only merzouki, braking-curve"),
        ("scenarios/shaft-merzouki.toml", &["run.control_period_us=2000"], "is of control period 1000 us"),
        ("scenarios/smooth-after.toml", &[], "is of plant backlash-shaft, the scenario has smooth"),
    ] {
        let error = error(name, settings).expect_err(name);
        assert!(error.contains(want) && error.contains("--map"), "{error}");
    }
}

#[test]
fn folder_of_a_campaign_is_a_map_only_with_the_three_axes() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = |name: &str, axes: &str| {
        let (file, out) = (folder.path().join(name).with_extension("toml"), folder.path().join(name));
        let contents = format!(
            "title = \"A map\"\nscenario = {:?}\nset = [\"run.duration_s=0.2\", 'expect=[{{ metric = \"settle_time_s\", unit = \"s\", max = 7 }}]']\n[[part]]\nname = \"map\"\nmethod = \
             \"grid\"\n{axes}[evidence]\nworst = 0\nof = \"settle_time_s\"\nfailures = 0\n",
            path("scenarios/shaft-merzouki.toml")
        );
        fs::write(&file, contents).expect("a file");
        let [file, out] = [file, out].map(|path| path.to_str().expect("a path of ASCII").to_owned());
        let ended = lashloop(&["campaign", "run", &file, "--out", &out], &[]);
        assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
        lashloop(&["budget", "--map", &out], &[])
    };
    let axis = |key: &str, values: &str| format!("[[part.axis]]\nkey = \"line.{key}\"\nvalues = {values}\n");
    let [loss, jitter, delay] =
        [axis("loss", "[0.0, 0.5]"), axis("jitter_us", "[0, 1000]"), axis("delay_us", "[0, 2000]")];
    let ended = campaign("whole", &format!("{loss}{jitter}{delay}"));
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    let map = text(&ended.stdout);
    assert!(map.contains("limit 7 s, loss 0.5\n       ms      0      2\n        0  never"), "{map}");
    let ended = campaign("part", &format!("{delay}{loss}"));
    assert_eq!(ended.status.code(), Some(2));
    let error = text(&ended.stderr);
    assert!(error.contains("line.delay_us, line.jitter_us, line.loss"), "{error}");
}
