//! The command line of `lashloop`, with the plant of this crate.

fn main() -> std::process::ExitCode {
    lashloop_cli::main(&lashloop::Bench::new().with_plant(own_plant::model()))
}
