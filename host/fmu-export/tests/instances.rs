//! Instances of exported FMUs, called as an importer calls them.

use std::fs;
use std::path::{Path, PathBuf};

use lashloop::{Bench, Scenario, run};
use lashloop_bench::run::digest::TorqueDigest;
use lashloop_fmu_export::{Instance, Kind, Part, Value, Version, export};
use tempfile::TempDir;
use zip::ZipArchive;

/// What an importer unpacks and reads.
struct Unpacked {
    folder: TempDir,
    description: String,
}

impl Unpacked {
    fn new(scenario: &Scenario, part: Part, version: Version) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let library = folder.path().join("library.so");
        fs::write(&library, lashloop_fmu_export::MARKER).expect("a file");
        let bytes = export(scenario, part, version, &library).expect("an FMU");
        ZipArchive::new(std::io::Cursor::new(bytes))
            .and_then(|mut it| it.extract(folder.path()))
            .expect("an archive");
        let description =
            fs::read_to_string(folder.path().join("modelDescription.xml")).expect("a description");
        Self { folder, description }
    }

    fn resources(&self) -> PathBuf {
        self.folder.path().join("resources")
    }

    fn token(&self) -> &str {
        let after = |name: &str| self.description.split_once(&format!("{name}=\"")).map(|(_, rest)| rest);
        let rest = after("guid").or_else(|| after("instantiationToken")).expect("a token");
        rest.split('"').next().unwrap_or_default()
    }

    /// The value reference of a variable.
    fn reference(&self, name: &str) -> u32 {
        let at = format!("name=\"{name}\" valueReference=\"");
        let (_, rest) = self.description.split_once(&at).unwrap_or_else(|| panic!("no variable {name}"));
        rest.split('"').next().and_then(|number| number.parse().ok()).expect("a reference")
    }

    fn instance(&self) -> Instance {
        Instance::new(&self.resources(), self.token()).expect("an instance")
    }

    fn started(&self) -> Instance {
        let mut instance = self.instance();
        instance.enter_initialization().expect("the initialization");
        instance.exit_initialization().expect("the end of the initialization");
        instance
    }
}

fn scenario(name: &str, settings: &[&str]) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name);
    Bench::new().scenario(path, settings).expect("a scenario")
}

fn real(instance: &mut Instance, reference: u32) -> f64 {
    let Value::Real(number) = instance.get(reference, Kind::Real).expect("a value") else {
        panic!("a number")
    };
    *number
}

#[test]
fn a_pair_gives_the_torques_of_a_run_bit_for_bit() {
    let lossy = [
        "run.duration_s=1.5",
        "encoders.noise_counts=1.5",
        "line.jitter_us=2500",
        "line.loss=0.05",
        "expect=[]",
    ];
    for (name, settings) in [
        ("shaft-pd.toml", &lossy[..]),
        ("shaft-bridge.toml", &["run.duration_s=1"][..]),
        ("shaft-triangle.toml", &lossy[..]),
    ] {
        let scenario = scenario(name, settings);
        let device = Bench::new().device("inproc").expect("a drive");
        let want = run(&scenario, &device).expect("a run").details().torque_sha256.clone();
        for version in [Version::Two, Version::Three] {
            let [plant_fmu, drive_fmu] =
                [Part::Plant, Part::Drive].map(|part| Unpacked::new(&scenario, part, version));
            let [mut plant, mut drive] = [&plant_fmu, &drive_fmu].map(Unpacked::started);
            let counts =
                ["motor_counts", "load_counts"].map(|it| (plant_fmu.reference(it), drive_fmu.reference(it)));
            let (given, taken) = (drive_fmu.reference("torque_nm"), plant_fmu.reference("torque_nm"));
            let (mut digest, period_s) = (TorqueDigest::default(), scenario.run.control_period_s());
            for step in 0..scenario.run.steps() {
                let time_s = f64::from(step) * period_s;
                for (of_plant, of_drive) in counts {
                    let read = plant.get(of_plant, Kind::Integer).expect("counts").clone();
                    drive.set(of_drive, read).expect("an input");
                }
                drive.step(time_s, period_s).expect("a step of the drive");
                let torque_nm = real(&mut drive, given);
                digest.push(torque_nm as f32);
                plant.set(taken, Value::Real(torque_nm)).expect("an input");
                plant.step(time_s, period_s).expect("a step of the plant");
            }
            assert_eq!(digest.finish(), want, "{name} with FMI {}", version.name());
        }
    }
}

#[test]
fn a_drifting_clock_meets_the_ends_of_the_periods() {
    let fmu = Unpacked::new(&scenario("shaft-pd.toml", &[]), Part::Plant, Version::Two);
    let [mut exact, mut drifting] = [(); 2].map(|()| fmu.started());
    let (torque, position) = (fmu.reference("torque_nm"), fmu.reference("motor_position_rad"));
    let mut sum_s = 0.0;
    for step in 0..20_000 {
        for instance in [&mut exact, &mut drifting] {
            instance.set(torque, Value::Real(f64::from(step % 100) / 100.0)).expect("an input");
        }
        exact.step(f64::from(step) / 1e3, 1e-3).expect("a step");
        drifting.step(sum_s, 1e-3).expect("a step of an importer that adds steps up");
        sum_s += 1e-3;
    }
    assert!(sum_s != 20.0, "the sum drifts");
    assert_eq!(real(&mut exact, position).to_bits(), real(&mut drifting, position).to_bits());
}

#[test]
fn resources_of_another_description_are_refused() {
    let [one, other] = ["1", "2"].map(|seed| {
        Unpacked::new(
            &scenario("smooth-after.toml", &[&format!("run.seed={seed}")]),
            Part::Plant,
            Version::Two,
        )
    });
    assert_ne!(one.token(), other.token());
    let error = Instance::new(&one.resources(), other.token()).err().expect("an error").to_string();
    assert!(
        error.contains("the description has the token") && error.ends_with("export the FMU again"),
        "{error}"
    );
    let of_three =
        Unpacked::new(&scenario("smooth-after.toml", &["run.seed=1"]), Part::Plant, Version::Three);
    assert_ne!(one.token(), of_three.token(), "an importer that unpacks each token once needs two");
}

#[test]
fn a_library_of_another_version_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let library = folder.path().join("library.so");
    fs::write(&library, "lashloop-fmu-library 0.0.9;").expect("a file");
    let scenario = scenario("smooth-after.toml", &[]);
    let error = export(&scenario, Part::Plant, Version::Two, &library).expect_err("another version");
    assert!(error.to_string().contains("isn't the library of this version"), "{error}");
}
