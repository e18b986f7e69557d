//! Counts the instructions of the codec on a Cortex-M4F: `cargo xtask image`, then
//! `cargo run -p tests --example codec_cost`.

#[path = "../tests/emulated/codec_cost.rs"]
mod codec_cost;

fn main() {
    print!("{}", codec_cost::count(&tests::workspace().join("target/codec-cost.elf")));
}
