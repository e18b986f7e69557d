//! The loop in C of `benchmarks/plant`, with which the speed of a run is compared: it makes the same motion.

use std::io::Write;
use std::process::{Command, Stdio};

use lashloop::Bench;

use super::in_process;

/// Samples that are compared: in the first swing, underway and at rest.
const SAMPLES: [usize; 3] = [500, 2000, 24_999];

#[test]
fn loop_in_c_moves_as_a_run_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("loop");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../benchmarks/plant/c/loop.c");
    let built = Command::new("cc").args(["-std=c11", "-O2", source, "-lm", "-o"]).arg(&program).status();
    assert!(built.expect("a C compiler").success(), "{source} does not compile");
    let mut child = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let requests: String = SAMPLES.iter().map(|sample| format!("loop {sample}\n")).collect();
    child.stdin.take().expect("a pipe").write_all(requests.as_bytes()).expect("the program reads");
    let output = child.wait_with_output().expect("an end");
    let in_c = String::from_utf8(output.stdout).expect("text");

    let outcome = in_process(&Bench::new(), "../scenarios/shaft-pd.toml", &[]).expect("a run");
    let columns =
        ["load_position_rad", "motor_position_rad"].map(|name| outcome.signal(name).expect("a column"));
    assert_eq!(in_c.lines().count(), SAMPLES.len());
    for (sample, line) in SAMPLES.into_iter().zip(in_c.lines()) {
        let ends_rad = line.split(' ').skip(1).map(|word| word.parse::<f64>().expect("a number"));
        for (column, have_rad) in columns.iter().zip(ends_rad) {
            let want_rad = column[sample];
            assert!(
                (have_rad - want_rad).abs() < 1e-6,
                "sample {sample}: C at {have_rad} rad, run at {want_rad}"
            );
        }
    }
}
