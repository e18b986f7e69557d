//! What a step of a plant in another process costs: `cargo run -p lashloop-bench --example process_plant_cost`, and that of an FMU
//! with `-- FILE TORQUE_INPUT MOTOR_OUTPUT LOAD_OUTPUT`. The loader of FMUs must be built.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use lashloop_bench::process_plant;
use lashloop_plant::{PlantModel, PlantValue, PlantValues, Release, Start};

/// A shell that answers each line with one constant line: the cost of the pipes alone.
const ANSWERING: &str = r#"read a
echo '{"lashloop_plant":1,"signals":[{"name":"a_rad","unit":"rad"}],"motor_position_rad":0,"load_position_rad":0,"values":[0]}'
while read b; do echo '{"motor_position_rad":0,"load_position_rad":0,"values":[0]}'; done"#;

const STEPS: usize = 5_000;

fn main() -> Result<(), Box<dyn Error>> {
    let model = process_plant::model(None);
    for (name, command) in
        [("sh", ["sh", "-c", ANSWERING].as_slice()), ("plant.py", &["python3", "plant.py"])]
    {
        let mut values = model.defaults();
        values.insert("command", list(command));
        measure(name, &model, &values)?;
    }
    let words: Vec<_> = std::env::args().skip(1).collect();
    if let [file, torque, motor, load] = &*words {
        let model = process_plant::fmu(None);
        let mut values = model.defaults();
        let keys = ["file", "torque_input", "motor_output", "load_output"];
        let file = std::path::absolute(file)?.display().to_string();
        for (key, value) in keys.into_iter().zip([&file, torque, motor, load]) {
            values.insert(key, PlantValue::Text(value.clone()));
        }
        // Examples are built into a folder in that of the programs.
        let program = std::env::current_exe()?.with_file_name("../lashloop-fmu");
        values.insert("command", list(&[&program.display().to_string()]));
        measure(&file, &model, &values)?;
    }
    Ok(())
}

fn list(words: &[&str]) -> PlantValue {
    PlantValue::List(words.iter().map(|word| PlantValue::Text((*word).to_owned())).collect())
}

fn measure(name: &str, model: &PlantModel, values: &PlantValues) -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plant-process");
    let start = Start::at_rest(0.0, 0.0);
    let mut plant = model.release(&Release { values, start, period_s: 1e-3, folder: &folder })?;
    let mut times_us = Vec::with_capacity(STEPS);
    for _ in 0..STEPS {
        let started = Instant::now();
        plant.step(0.5, 1e-3)?;
        times_us.push(started.elapsed().as_secs_f64() * 1e6);
    }
    times_us.sort_by(f64::total_cmp);
    let at = |fraction: f64| times_us[(fraction * STEPS as f64) as usize];
    println!("{name}: median {:.0} us, 99 % within {:.0} us", at(0.5), at(0.99));
    Ok(())
}
