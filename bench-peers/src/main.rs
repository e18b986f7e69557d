//! The codec beside others: `cargo run --release --manifest-path bench-peers/Cargo.toml`.
//!
//! All sides run in one process, in turn, round after round; each figure is the median of the rounds, so that what
//! disturbs the machine disturbs all of them. Values vary from message to message.

mod codec;
mod cycle;
mod load;
mod measure;
mod stream;

use measure::{Figures, Side, measure};

fn main() {
    let (samples, torques) = (cycle::samples(), cycle::torques());
    println!("load before: {}", load::word());
    let mut sides: Vec<Box<dyn Side>> = vec![
        <dyn Side>::of::<codec::ours::Ours>("lashloop", &samples, &torques),
        <dyn Side>::of::<codec::floor::Floor>("floor: copy and CRC-32C", &samples, &torques),
        <dyn Side>::of::<codec::postcard::Postcard>("postcard, CRC-32, cobs", &samples, &torques),
        <dyn Side>::of::<codec::protobuf::Protobuf>("prost, cobs (no CRC)", &samples, &torques),
        <dyn Side>::of::<codec::mavlink::Mavlink>(
            "mavlink HIL_SENSOR, HIL_ACTUATOR_CONTROLS",
            &samples,
            &torques,
        ),
    ];
    let figures = measure(&mut sides);
    table(&figures);
    stream::table(&stream::measure(&samples));
    println!("load after: {}", load::word());
}

fn table(figures: &[Figures]) {
    println!(
        "| codec | sample: encode ns | decode ns | bytes | torque: encode ns | decode ns | bytes | bytes per cycle |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for side in figures {
        let [(se, sd, sb), (te, td, tb)] =
            [&side.sample, &side.torque].map(|m| (m.encode_ns, m.decode_ns, m.bytes));
        println!(
            "| {} | {se:.1} | {sd:.1} | {sb:.1} | {te:.1} | {td:.1} | {tb:.1} | {:.1} |",
            side.name,
            sb + tb
        );
    }
    let ours = &figures[0];
    for side in &figures[1..] {
        println!(
            "{} over lashloop: sample encode {:.2}, decode {:.2}; torque encode {:.2}, decode {:.2}",
            side.name,
            side.sample.encode_ns / ours.sample.encode_ns,
            side.sample.decode_ns / ours.sample.decode_ns,
            side.torque.encode_ns / ours.torque.encode_ns,
            side.torque.decode_ns / ours.torque.decode_ns,
        );
    }
}
