//! What a run leaves is what it was.

use std::fs;

use lashloop_bench::run::StepObserver;
use lashloop_record::columns::Columns;
use lashloop_record::folder::RecordFolder;
use lashloop_record::manifest::{Manifest, Number};
use lashloop_record::reader::Record;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;

use super::{bits, run_in_process, scenario};

#[test]
fn samples_read_back_to_the_bits_of_the_run() {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = RecordFolder::claim(&parent.path().join("run"), false).expect("a folder");
    // A fault of an encoder, telemetry in every third step, and chunks that don't end with the run.
    let settings = [
        "run.duration_s=1.2347",
        "telemetry.every_steps=3",
        "record.flush_rows=100",
        "expect=[]",
        "controller.parameters.torque_limit_nm=12.5",
        "fault=[{ kind=\"encoder-offset\", side=\"load\", counts=60, over_s=0.1, at_s=0.2 }]",
    ];
    let scenario = scenario("shaft-sine.toml", &settings);
    let mut memory = Columns::default();
    let mut writer = RecordWriter::new(folder, RunSource::default());
    let observers: Vec<&mut dyn StepObserver> = vec![&mut memory, &mut writer];
    let outcome = run_in_process(&scenario, observers).expect("a run");
    drop(writer);
    let record = Record::read(&parent.path().join("run")).expect("a record");
    assert_eq!(record.trace.len() as u64, outcome.steps);
    assert_eq!(bits(&record.trace), bits(&memory));
    assert!(!record.is_torn, "a writer that is dropped ends its file");

    let manifest: Manifest = record.manifest;
    assert_eq!((manifest.law.as_str(), manifest.period_us), (scenario.controller.name.as_str(), 1000));
    let text = fs::read_to_string(parent.path().join("run/record.json")).expect("a manifest");
    assert_eq!(manifest.to_json(), text, "both ways");
    let limit =
        manifest.parameters.iter().find(|it| it.name == "torque_limit_nm").expect("every drive has it");
    assert_eq!(
        (limit.value, limit.default),
        (Number::Real(12.5), Number::Real(20.0)),
        "in force and default"
    );
}
