//! The torques of every law, bit for bit. They change only with a stated change of a law.

use lashloop_protocol::enums::ParameterValue;

use crate::host::{Host, torque};

/// FNV-1a of the bits of 3000 torques: a decaying oscillation of motor and load through the gap, with one lost sample.
fn digest(settings: &[(&str, ParameterValue)]) -> u64 {
    let limit = ("torque_limit_nm", ParameterValue::F32(100.0));
    let coulomb = ("motor_coulomb_nm", ParameterValue::F32(0.02));
    let mut host = Host::running(&[&[limit, coulomb], settings].concat());
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    let (mut motor, mut load, mut velocity) = (3 * 32_768_i64, 32_768_i64, 0_i64);
    for sequence in (0..3000_u16).filter(|sequence| *sequence != 1000) {
        // Integers, so that no machine rounds them otherwise.
        velocity -= motor / 900 + velocity / 200;
        motor += velocity / 16;
        load += (motor - 3 * load) / 1500;
        let torque_nm = torque(&host.sample(sequence, motor, load)).torque_nm;
        for byte in torque_nm.to_bits().to_le_bytes() {
            digest = (digest ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    digest
}

#[test]
fn torques_of_every_law_keep_their_bits() {
    let controller = |law| ("controller", ParameterValue::U32(law));
    let source = |source| ("disturbing_torque_source", ParameterValue::U32(source));
    let fine = ("motor_counts_per_rev", ParameterValue::U32(100_003));
    let have = [
        digest(&[controller(0)]),
        digest(&[controller(1), source(1)]),
        digest(&[controller(1), source(0)]),
        digest(&[controller(2)]),
        digest(&[controller(3)]),
        digest(&[controller(3), fine]),
    ];
    let want = [
        "22a1cf8442aa2bb4",
        "d64836dab3a0685c",
        "6980f4f67b2d5acf",
        "1e4c8e38c4c4b95c",
        "75b3a2421da83332",
        "286c0eb5b83126aa",
    ];
    assert_eq!(have.map(|digest| format!("{digest:016x}")), want);
}
