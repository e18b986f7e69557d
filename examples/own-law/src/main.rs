//! The command line of `lashloop`, with the laws of this crate in `inproc` and `native`.

fn main() -> std::process::ExitCode {
    lashloop_cli::main(&lashloop::Bench::new().with_laws::<own_law::OwnLaws>())
}
