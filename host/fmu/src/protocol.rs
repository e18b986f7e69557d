//! The plant-process protocol: one line of JSON in, one out. `docs/extend/plant.md` has it.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Write};

use rustix::stdio;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::error::FmuError;
use crate::plant::{Plant, Settings};

const VERSION: u32 = 1;

#[derive(Deserialize)]
struct Hello {
    lashloop_plant: u32,
    period_s: f64,
    settings: Settings,
}

#[derive(Deserialize)]
struct Held {
    torque_nm: f64,
    dt_s: f64,
}

/// Serves one run, to the end of standard input. What the FMU does wrong goes to the bench, as the last line.
pub(crate) fn serve() -> Result<(), FmuError> {
    // An FMU that leaks memory ends this process, not the bench. Without /proc it is the system's choice.
    let _ = fs::write("/proc/self/oom_score_adj", "1000");
    let (input, mut output) = own_ends()?;
    let served = answer(&mut BufReader::new(input), &mut output);
    if let Err(error) = &served
        && !matches!(error, FmuError::Pipe(_))
    {
        send(&mut output, &json!({ "error": error.to_string() }))?;
        return Ok(());
    }
    served
}

/// Both ends for the protocol alone, closed in programs that the FMU starts. The FMU reads nothing from standard input, and what
/// it prints goes to standard error.
fn own_ends() -> io::Result<(File, File)> {
    let first_free = stdio::raw_stderr() + 1;
    let input = rustix::io::fcntl_dupfd_cloexec(stdio::stdin(), first_free)?;
    let output = rustix::io::fcntl_dupfd_cloexec(stdio::stdout(), first_free)?;
    stdio::dup2_stdin(File::open("/dev/null")?)?;
    stdio::dup2_stdout(stdio::stderr())?;
    Ok((input.into(), output.into()))
}

fn answer(input: &mut impl BufRead, output: &mut File) -> Result<(), FmuError> {
    let mut line = String::new();
    if input.read_line(&mut line)? == 0 {
        return Ok(());
    }
    let hello: Hello = parse(&line)?;
    if hello.lashloop_plant != VERSION {
        let reason = format!("it has version {} of the protocol, not {VERSION}", hello.lashloop_plant);
        return Err(FmuError::Line { line, reason });
    }
    let mut plant = Plant::start(&hello.settings, hello.period_s)?;
    let signals: Vec<_> = plant.signals().map(|(name, unit)| json!({ "name": name, "unit": unit })).collect();
    let mut values = Vec::new();
    plant.outputs(&mut values)?;
    let mut first = state(&values);
    first["lashloop_plant"] = VERSION.into();
    first["signals"] = signals.into();
    send(output, &first)?;
    loop {
        line.clear();
        if input.read_line(&mut line)? == 0 {
            plant.end();
            return Ok(());
        }
        let Held { torque_nm, dt_s } = parse(&line)?;
        plant.step(torque_nm, dt_s)?;
        plant.outputs(&mut values)?;
        send(output, &state(&values))?;
    }
}

fn state(values: &[f64]) -> Value {
    json!({ "motor_position_rad": values[0], "load_position_rad": values[1], "values": values[2..] })
}

fn parse<'a, T: Deserialize<'a>>(line: &'a str) -> Result<T, FmuError> {
    serde_json::from_str(line).map_err(|error| FmuError::Line {
        line: line.trim_end().chars().take(120).collect(),
        reason: error.to_string(),
    })
}

fn send(output: &mut File, message: &Value) -> io::Result<()> {
    output.write_all(format!("{message}\n").as_bytes())
}
