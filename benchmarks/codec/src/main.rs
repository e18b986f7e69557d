//! The codec compared with others: `cargo run --release --manifest-path benchmarks/codec/Cargo.toml`.
//!
//! All sides run in one process, in turn, round after round. Each figure is the median of the rounds, so that other load affects
//! all sides. Values vary from message to message. docs/performance.md holds the output.

mod codec;
mod cycle;
mod goals;
mod load;
mod measure;
mod stream;

use measure::{Figures, Side, measure};

fn main() {
    let (samples, torques) = (cycle::samples(), cycle::torques());
    let load_before = load::word();
    let sides = vec![
        Side::of::<codec::ours::Ours>("lashloop", &samples, &torques),
        Side::of::<codec::floor::Floor>("floor: copy and CRC-32C", &samples, &torques),
        Side::of::<codec::postcard::Postcard>("postcard, CRC-32C, cobs", &samples, &torques),
        Side::of::<codec::protobuf::Protobuf<true>>("prost, CRC-32C, cobs", &samples, &torques),
        Side::of::<codec::protobuf::Protobuf<false>>("prost, cobs, no check", &samples, &torques),
        Side::of::<codec::mavlink::Mavlink>("mavlink HIL_SENSOR, HIL_ACTUATOR_CONTROLS", &samples, &torques),
    ];
    let figures = measure(sides);
    table(&figures);
    let streams = stream::measure(&samples);
    println!();
    stream::table(&streams);
    println!();
    goals::table(&figures, &streams);
    println!("\nLoad of the machine in this run: {load_before} before it, {} after.", load::word());
}

fn table(figures: &[Figures]) {
    println!(
        "| codec | sample: encode ns | decode ns | bytes | torque: encode ns | decode ns | bytes | bytes per cycle | at most |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for Figures { name, ns: [sample_encode, sample_decode, torque_encode, torque_decode], bytes, .. } in
        figures
    {
        let [sample, torque] = bytes;
        println!(
            "| {name} | {sample_encode:.1} | {sample_decode:.1} | {:.1} | {torque_encode:.1} | {torque_decode:.1} | {:.1} | {:.1} | {} |",
            sample.mean,
            torque.mean,
            sample.mean + torque.mean,
            sample.longest + torque.longest
        );
    }
}
