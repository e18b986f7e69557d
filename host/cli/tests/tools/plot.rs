//! `lashloop plot` on complete, truncated and malformed records.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::samples;
use crate::support::{lashloop, root, text};

/// Folders with records of 0.1 s.
struct Runs(TempDir);

impl Runs {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn folder(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, name: &str, settings: &[&str]) -> PathBuf {
        let (scenario, out) = (root().join("scenarios/faults.toml"), self.folder(name));
        let mut arguments = vec!["run", scenario.to_str().unwrap(), "--device", "inproc"];
        // A run this short can't measure what the scenario expects; only its record matters here.
        arguments.extend([
            "--out",
            out.to_str().unwrap(),
            "--set",
            "run.duration_s=0.1",
            "--set",
            "expect=[]",
        ]);
        arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
        let ended = lashloop(&arguments, &[]);
        assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
        out
    }
}

fn plot(arguments: &[&Path]) -> Result<String, String> {
    let arguments: Vec<&str> = arguments.iter().map(|argument| argument.to_str().unwrap()).collect();
    let ended = lashloop(&[&["plot"], &arguments[..]].concat(), &[]);
    match ended.status.code() {
        Some(0) => Ok(text(&ended.stdout).to_owned()),
        Some(2) => Err(text(&ended.stderr).to_owned()),
        code => panic!("{code:?}: {}", text(&ended.stderr)),
    }
}

#[test]
fn record_is_plotted_into_its_folder() {
    let runs = Runs::new();
    let one = runs.run("one", &[]);
    let output = plot(&[&one]).unwrap();
    let figure = one.join("record.svg");
    assert_eq!(output, format!("figure: {}\n", figure.display()));
    let svg = fs::read_to_string(figure).unwrap();
    for words in
        ["Record of one", "Load position", "edges of the gap", "Round trip", "100 steps, all answered."]
    {
        assert!(svg.contains(words), "no {words:?}");
    }
    assert!(!svg.contains("no data"), "every panel has a curve");
}

#[test]
fn several_records_share_axes_and_common_curves() {
    let runs = Runs::new();
    let (one, other) =
        (runs.run("one", &[]), runs.run("other", &["plant.dead_zone_rad=0.2", "meant=mismatch"]));
    let figure = runs.folder("both.svg");
    plot(&[&one, &other, Path::new("--out"), &figure]).unwrap();
    let svg = fs::read_to_string(figure).unwrap();
    let curves = |label: &str| svg.matches(&format!("<title>{label}</title>")).count();
    assert_eq!((curves("one"), curves("other")), (6, 6), "one in each panel");
    assert_eq!(curves("reference"), 1, "both follow the same");
    assert_eq!(curves("edges of the gap"), 2, "the gaps differ");
}

#[test]
fn folders_with_equal_names_are_labelled_by_path() {
    let (here, there) = (Runs::new(), Runs::new());
    let (one, other) = (here.run("one", &[]), there.run("one", &[]));
    let figure = here.folder("both.svg");
    plot(&[&one, &other, Path::new("--out"), &figure]).unwrap();
    let svg = fs::read_to_string(figure).unwrap();
    for folder in [&one, &other] {
        assert!(svg.contains(&format!("<title>{}</title>", folder.display())), "{}", folder.display());
    }
}

#[test]
fn only_the_selected_range_is_plotted() {
    let runs = Runs::new();
    let one = runs.run("one", &[]);
    plot(&[&one, Path::new("--from=0.05"), Path::new("--until=0.06")]).unwrap();
    let svg = fs::read_to_string(one.join("record.svg")).unwrap();
    assert!(svg.contains(">0.050<") && svg.contains(">0.060<") && !svg.contains(">0.10<"), "other times");
    let error = plot(&[&one, Path::new("--from=2"), Path::new("--until=1")]).unwrap_err();
    assert!(error.contains("--until must be later than --from"), "{error}");
    let error = plot(&[&one, Path::new("--from=30")]).unwrap_err();
    assert!(error.contains("no step lies in the range from 30 s on; the records end at 0.099 s"), "{error}");
}

#[test]
fn killed_run_is_plotted_up_to_its_last_whole_chunk() {
    let runs = Runs::new();
    let one = runs.run("one", &["record.flush_rows=20"]);
    fs::remove_file(one.join("summary.json")).unwrap();
    let samples = fs::read(one.join("run.mcap")).unwrap();
    fs::write(one.join("run.mcap"), &samples[..samples.len() * 2 / 3]).unwrap();
    plot(&[&one]).unwrap();
    let svg = fs::read_to_string(one.join("record.svg")).unwrap();
    for words in
        ["ended without a verdict", "0 steps, all answered", "last chunk of the record is incomplete"]
    {
        assert!(svg.replace("</tspan>", " ").contains(words), "no {words:?}: {svg}");
    }
}

#[test]
fn unusable_record_is_named_by_its_file() {
    let runs = Runs::new();
    let nowhere = runs.folder("nowhere");
    let error = plot(&[&nowhere]).unwrap_err();
    assert!(error.contains("nowhere: the folder doesn't exist"), "{error}");

    let one = runs.run("one", &[]);
    samples::rename(&one, "torque_nm", "torpor_nm");
    let error = plot(&[&one]).unwrap_err();
    assert!(error.contains("run.mcap: there is no column torque_nm"), "{error}");

    samples::rewrite(&one, |_| false);
    let error = plot(&[&one]).unwrap_err();
    assert!(error.contains("run.mcap: has no rows"), "{error}");

    fs::write(one.join("run.mcap"), "no samples").unwrap();
    let error = plot(&[&one]).unwrap_err();
    assert!(error.contains("run.mcap: can't be read as MCAP"), "{error}");
}

#[test]
fn any_signal_gets_a_panel_with_its_unit() {
    let runs = Runs::new();
    let one = runs.run("one", &[]);
    let [option, torque, energy] =
        ["--signal", "drive.requested_torque_nm", "stored_energy_j"].map(Path::new);
    plot(&[&one, option, torque, energy]).unwrap();
    let svg = fs::read_to_string(one.join("record.svg")).unwrap();
    // The axis of a small energy carries a power of ten before its unit.
    for words in ["drive.requested_torque_nm (N m)", "stored_energy_j (", " J)<"] {
        assert!(svg.contains(words), "no {words:?}: {svg}");
    }
    let error = plot(&[&one, Path::new("--signal"), Path::new("requested_torque")]).unwrap_err();
    let wanted = "requested_torque: the record has no signal of this name (did you mean drive.requested_torque_nm?); \
                  it has time_s, ";
    assert!(error.contains(wanted), "{error}");
}

#[test]
fn record_without_gap_and_estimator_has_the_other_panels() {
    let runs = Runs::new();
    let one = runs.run("one", &["telemetry.every_steps=0"]);
    samples::rename(&one, "twist_rad", "bend_rad");
    plot(&[&one]).unwrap();
    let svg = fs::read_to_string(one.join("record.svg")).unwrap();
    assert!(svg.contains("Control torque") && !svg.contains("no data"), "{svg}");
    assert!(!svg.contains("Twist and the gap") && !svg.contains("Dead-zone estimate"), "{svg}");
}

#[test]
fn panels_take_the_place_of_the_standard_ones_and_group_by_unit() {
    let runs = Runs::new();
    let (one, other) =
        (runs.run("one", &[]), runs.run("other", &["plant.dead_zone_rad=0.2", "meant=mismatch"]));
    let figure = runs.folder("both.svg");
    let panels = ["--panel=load_position_rad,reference_rad", "--panel=drive.*", "--out"].map(Path::new);
    plot(&[&[&*one, &other], &panels[..], &[&figure]].concat()).unwrap();
    let svg = fs::read_to_string(figure).unwrap();
    assert!(!svg.contains("Control torque") && svg.contains(") drive.* in N m<"), "{svg}");
    let pens = |label: &str| {
        let line = svg.lines().find(|line| line.contains(&format!("<title>{label}</title>"))).unwrap();
        let pen = line.split_once("stroke=").unwrap().1;
        pen.split_once('>').unwrap().0.to_owned()
    };
    let labels =
        ["load_position_rad, one", "load_position_rad, other", "reference_rad, one", "reference_rad, other"];
    let mut all = labels.map(pens).to_vec();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), 4, "each line has a colour and a dash of its own: {all:?}");
    let error = plot(&[&one, Path::new("--panel=drive.q*")]).unwrap_err();
    assert!(error.contains("drive.q*: the record has no signal of this name"), "{error}");
}

#[test]
fn a_capture_has_the_torques_of_the_record_on_the_same_axis() {
    let runs = Runs::new();
    let capture = runs.folder("line.pcapng");
    let scenario = root().join("scenarios/faults.toml");
    let out = runs.folder("one");
    let [scenario, file, folder] = [&scenario, &capture, &out].map(|path| path.to_str().unwrap());
    let settings = ["run.duration_s=0.1", "expect=[]"].iter().flat_map(|it| ["--set", it]);
    let run = ["run", scenario, "--device", "inproc", "--capture", file, "--out", folder];
    let ended = lashloop(&run.into_iter().chain(settings).collect::<Vec<_>>(), &[]);
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    let figure = runs.folder("both.svg");
    plot(&[&out, &capture, Path::new("--panel=torque_nm"), Path::new("--out"), &figure]).unwrap();
    let svg = fs::read_to_string(figure).unwrap();
    let curve = |label: &str| {
        let line = svg.lines().find(|line| line.contains(&format!("<title>{label}</title>"))).unwrap();
        line.split_once('"').unwrap().1.split_once('"').unwrap().0.to_owned()
    };
    assert_eq!(curve("one"), curve("line.pcapng"), "the same torques at the same times");

    plot(&[&capture]).unwrap();
    let svg = fs::read_to_string(capture.with_extension("svg")).unwrap();
    for words in
        ["Capture line.pcapng", "motor_counts", "drive.requested_torque_nm", "100 steps from the frames"]
    {
        assert!(svg.contains(words), "no {words:?}: {svg}");
    }
    let whole = fs::read(&capture).unwrap();
    fs::write(&capture, &whole[..whole.len() - 7]).unwrap();
    plot(&[&capture]).unwrap();
    assert!(fs::read_to_string(capture.with_extension("svg")).unwrap().contains("breaks off"));
    fs::write(&capture, "nothing").unwrap();
    assert!(plot(&[&capture]).unwrap_err().contains("must be a capture"));
}

#[test]
fn a_figure_is_a_picture_if_its_name_ends_so() {
    let runs = Runs::new();
    let one = runs.run("one", &[]);
    let figure = runs.folder("one.PNG");
    plot(&[&one, Path::new("--out"), &figure]).unwrap();
    let refused = plot(&[&one, Path::new("--out"), Path::new("one.pdf")]).unwrap_err();
    assert!(refused.contains("end the file in .svg or .png"), "{refused}");
    let picture = fs::read(figure).unwrap();
    assert_eq!(picture[..8], *b"\x89PNG\r\n\x1a\n");
    assert!(picture.len() > 20_000, "{} bytes", picture.len());
}
