//! FMUs of independent exporters as plants, and FMUs for model exchange with the solver of FMPy.

use std::process::Command;

use tests::fmu::{FmuFolder, LINUX, PLANT, START, difference_rad};
use tests::program::Ended;
use tests::python::interpreter;
use tests::records::Records;
use tests::workspace;

/// The library of the interpreter, which an FMU of pythonfmu needs.
fn library() -> String {
    let program = "import sysconfig; print(*sysconfig.get_config_vars('LIBDIR', 'INSTSONAME'), sep='/')";
    let found = Command::new(interpreter()).args(["-c", program]).output().expect("Python starts");
    let path = String::from_utf8_lossy(&found.stdout).trim().to_owned();
    // Debian has it elsewhere; the loader of the system finds it by its name.
    let is_there = std::path::Path::new(&path).exists();
    if is_there { path } else { path.rsplit('/').next().unwrap_or_default().to_owned() }
}

fn passed(fmu: &FmuFolder, plant: &str, duration_s: f64) -> Records {
    let records = Records::new();
    let _: Ended = fmu.run(plant, duration_s, &records, &[]).with_code(0);
    fmu.check_nothing_is_left();
    records
}

/// An FMU that `exporter` builds from a slave in Python.
fn of_exporter(exporter: &str, slave: &str, unit: &str) {
    let fmu = FmuFolder::empty();
    let data = workspace().join("tests/data/fmu");
    let mut build = Command::new(interpreter());
    build.args(["-m", exporter, "build", "-f"]).arg(data.join(slave)).arg("-d").arg(fmu.path(""));
    assert!(
        build.arg(data.join("smooth_plant.py")).status().expect("Python starts").success(),
        "{exporter} fails"
    );
    let variables =
        [("plant.fmu", "Plant.fmu"), ("motor.phi", "motor"), ("load.phi", "load"), (", \"steps\"", "")];
    let plant = variables.iter().fold(PLANT.to_owned(), |text, (ours, its)| text.replace(ours, its));
    let start = START.replace("motor.start", "motor_start").replace("load.start", "load_start");
    let plant = format!("{plant}preload = [{:?}]\n{start}", library());
    let [first, second] = [(); 2].map(|()| passed(&fmu, &plant, 2.0));
    assert_eq!(first.summary()["torque_sha256"], second.summary()["torque_sha256"]);
    assert_eq!(first.record().manifest.plant_signals[0].unit, unit);
    let smooth = passed(&fmu, "[plant]\nmodel = \"smooth\"\n", 2.0);
    let off_rad = difference_rad(&first, &smooth);
    assert!(off_rad <= 1e-9, "{off_rad} rad");
}

pub(crate) fn two() {
    of_exporter("pythonfmu", "slave_two.py", "");
}

pub(crate) fn three() {
    of_exporter("pythonfmu3", "slave_three.py", "rad");
}

pub(crate) fn model_exchange() {
    let fmu = FmuFolder::new("two", &LINUX);
    let exchange = format!(
        "{PLANT}command = [{:?}, \"-m\", \"lashloop.fmu\"]\n{START}",
        interpreter().display().to_string()
    );
    let exchange = exchange.replace(", \"steps\"", "");
    let [first, second] = [(); 2].map(|()| passed(&fmu, &exchange, 1.0));
    assert_eq!(first.summary()["torque_sha256"], second.summary()["torque_sha256"]);
    // Both integrate well below an encoder count, so that the drive sees one plant.
    let off_rad = difference_rad(&first, &passed(&fmu, &format!("{PLANT}{START}substeps = 64\n"), 1.0));
    assert!(off_rad <= 1e-3, "{off_rad} rad");
    let wrong = exchange.replace("\"load.phi\"", "\"load.ph\"");
    let ended = fmu.run(&wrong, 1.0, &Records::new(), &[]).with_code(2);
    assert!(
        ended.stderr.contains("no variable 'load.ph', which plant.load_output names; it has load.phi"),
        "{}",
        ended.stderr
    );
}
