//! Parameters of a persistent drive: list, set, dump and restore.

use std::fs;

use tests::paper::PATIENCE;
use tests::program::{Ended, run};
use tests::twin::Twin;

fn parameters(twin: &Twin, words: &[&str]) -> Ended {
    run(["parameters", "--device", &twin.device()].iter().chain(words))
}

fn hash(twin: &Twin) -> String {
    parameters(twin, &["hash"]).with_code(0).stdout
}

#[test]
fn a_set_value_persists_and_changes_list_and_hash() {
    let twin = Twin::start();
    let before = hash(&twin);
    assert_eq!(before, hash(&twin));
    assert_eq!(before.trim_end().len(), 64);
    let ended = parameters(&twin, &["set", "torque_limit_nm=5", "controller=merzouki"]).with_code(0);
    assert_eq!(ended.stdout, "controller = \"merzouki\"\ntorque_limit_nm = 5.0\n");
    assert_ne!(before, hash(&twin));
    let list = parameters(&twin, &["list"]).with_code(0).stdout;
    let row = list.lines().find(|line| line.starts_with("torque_limit_nm ")).expect("a row of the parameter");
    let words: Vec<_> = row.split_whitespace().collect();
    assert_eq!(words, ["torque_limit_nm", "5.0", "20.0", "no", "0", "to", "1000", "N", "m", "all"]);
    let own = list.lines().find(|line| line.starts_with("k_21 ")).expect("a parameter of two laws");
    assert!(own.ends_with("merzouki and merzouki-as-printed"), "{own}");
    assert!(
        list.contains(
            "\nlaws: pd, merzouki, merzouki-as-printed, backlash-inverse, braking-curve, open-loop\n"
        ),
        "{list}"
    );
    assert!(list.contains("\nrequested_torque_nm            N m    all\n"), "{list}");
}

#[test]
fn a_restored_dump_restores_every_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.toml").display().to_string();
    let twin = Twin::start();
    // Numbers that need many digits, and extremes of the notation of single precision.
    let words =
        ["set", "k_p1=0.1", "k_d1=0.3333333", "motor_inertia_kg_m2=1e-9", "stiffness_nm_rad=987654321"];
    let _ = parameters(&twin, &words).with_code(0);
    let wanted = hash(&twin);
    fs::write(&file, parameters(&twin, &["dump"]).with_code(0).stdout).expect("a file");
    let other = Twin::start();
    assert_ne!(wanted, hash(&other));
    let _ = parameters(&other, &["restore", &file]).with_code(0);
    assert_eq!(wanted, hash(&other));
}

#[test]
fn a_drive_without_a_memory_for_parameters_is_named_with_what_to_do() {
    let twin = Twin::start();
    for verb in ["store", "recall", "forget"] {
        let error = parameters(&twin, &[verb]).with_code(2).stderr;
        assert!(
            error.contains("(capability STORE)") && error.contains("`lashloop parameters dump`"),
            "{error}"
        );
    }
}

#[test]
fn a_run_resets_all_parameters() {
    let twin = Twin::start();
    let _ = parameters(&twin, &["set", "load_speed_limit_rad_s=0.2"]).with_code(0);
    let device = twin.device();
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", &device];
    let _ = run(arguments.into_iter().chain(PATIENCE)).with_code(0);
    let list = parameters(&twin, &["list"]).with_code(0).stdout;
    let row = list
        .lines()
        .find(|line| line.starts_with("load_speed_limit_rad_s "))
        .expect("a row of the parameter");
    assert_eq!(row.split_whitespace().nth(1), Some("100.0"));
}

#[test]
fn errors_name_the_place_and_set_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.toml").display().to_string();
    let twin = Twin::start();
    let before = hash(&twin);
    let unknown = parameters(&twin, &["set", "k_p1=2", "torque_limit=5"]).with_code(2).stderr;
    let wanted = "lashloop: set torque_limit=5: torque_limit = 5: the drive has no parameter of this name \
        (did you mean torque_limit_nm?); it has controller, ";
    assert!(unknown.starts_with(wanted), "{unknown}");
    fs::write(&file, "k_p1 = 2.0\n\ntorque_limit_nm = 2000\n").expect("a file");
    let high = parameters(&twin, &["restore", &file]).with_code(2).stderr;
    let wanted = format!(
        "lashloop: {file}:3: torque_limit_nm = 2000: the drive takes 0 to 1000 N m; nothing has been set\n"
    );
    assert_eq!(high, wanted);
    fs::write(&file, "k_p1 = 2.0\nk_p1 = 3.0\n").expect("a file");
    let twice = parameters(&twin, &["restore", &file]).with_code(2).stderr;
    assert!(twice.starts_with(&format!("lashloop: {file}:2: ")), "{twice}");
    fs::write(&file, "k_p1 = \"two\"\n").expect("a file");
    let text = parameters(&twin, &["restore", &file]).with_code(2).stderr;
    let wanted = "it is a text; the drive takes 0 to 1000000 N m/rad; nothing has been set";
    assert_eq!(text, format!("lashloop: {file}:1: k_p1 = two: {wanted}\n"));
    fs::write(&file, "k_p1 = [2.0]\n").expect("a file");
    let list = parameters(&twin, &["restore", &file]).with_code(2).stderr;
    let wanted = "k_p1 isn't a setting; it must be NAME = NUMBER or NAME = \"CHOICE\"";
    assert_eq!(list, format!("lashloop: {file}:1: {wanted}\n"));
    let choice = parameters(&twin, &["set", "disturbing_torque_source=observer"]).with_code(2).stderr;
    assert!(
        choice.contains("this parameter has no choice of this name (did you mean observed?)"),
        "{choice}"
    );
    let word = parameters(&twin, &["set", "k_p1"]).with_code(2).stderr;
    assert_eq!(word, "lashloop: set k_p1: no setting; it must be NAME=NUMBER or NAME=CHOICE\n");
    assert_eq!(before, hash(&twin));
}
