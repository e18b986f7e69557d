//! Records of format 2: messages of ROS 1, at times from the start of the run.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;

use lashloop_record::samples::{RecordedEdge, RecordedText, Samples};
use mcap::records::MessageHeader;

/// Writes the messages of each topic, with its encoding.
fn written(encoding: &str) -> Vec<u8> {
    let mut file = mcap::Writer::new(Cursor::new(Vec::new())).expect("a file");
    let mut channel = |topic: &str, schema: &str| {
        let schema = file.add_schema(topic, "ros1msg", schema.as_bytes()).expect("a schema");
        let metadata = BTreeMap::from([("period_us".to_owned(), "1000".to_owned())]);
        file.add_channel(schema, topic, encoding, &metadata).expect("a channel")
    };
    let step = channel(
        "/step",
        "float32 torque_nm # torque_nm [N m]\nuint8 sampled # sampled []\nint32 motor_counts # motor_counts [counts]\n\
         float64 twist_rad # twist_rad [rad]\n",
    );
    let drive = channel("/drive", "float32 load_error_rad # drive.load_error_rad [rad]\n");
    let fault = channel("/fault", "string kind\nuint32 number\nuint8 begins\n");
    let log = channel("/log", "string text\n");
    let mut write = |channel_id, sequence, step: u64, log_step: u64, data: &[&[u8]]| {
        let (log_time, publish_time) = (1_000_000 * log_step, 1_000_000 * step);
        let head = MessageHeader { channel_id, sequence, log_time, publish_time };
        file.write_to_known_channel(&head, &data.concat()).expect("a message");
    };
    for number in 0..3_u64 {
        let (torque_nm, twist_rad) = (0.5_f32 * number as f32, 0.1 * number as f64);
        let counts = -7 * number as i32;
        let data = [&torque_nm.to_le_bytes()[..], &[1], &counts.to_le_bytes(), &twist_rad.to_le_bytes()];
        write(step, 0, number, number, &data);
    }
    write(drive, 2, 2, 1, &[&0.25_f32.to_le_bytes()]);
    write(fault, 0, 2, 2, &[&11_u32.to_le_bytes(), b"torque-gain", &3_u32.to_le_bytes(), &[1]]);
    write(log, 1, 2, 2, &[&3_u32.to_le_bytes(), b"low"]);
    file.finish().expect("an end");
    file.into_inner().into_inner()
}

#[test]
fn samples_of_format_2_are_read_to_the_same_bits() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    fs::write(&path, written("ros1")).expect("a file");
    let Samples { trace, faults, logs, is_torn, .. } = Samples::read(&path).expect("samples");
    let column = |name: &str| trace.get(name).unwrap_or_else(|| panic!("no column {name}")).to_vec();
    assert_eq!(column("time_s"), [0.0, 0.001, 0.002]);
    assert_eq!(column("torque_nm"), [0.0, 0.5, 1.0]);
    assert_eq!(column("motor_counts"), [0.0, -7.0, -14.0]);
    assert_eq!(column("twist_rad"), [0.0, 0.1, 0.2]);
    assert_eq!((column("drive.load_error_rad")[2], column("telemetry_time_s")[2]), (0.25, 0.001));
    assert_eq!(faults, [RecordedEdge { step: 2, kind: "torque-gain".to_owned(), number: 3, begins: true }]);
    assert_eq!(logs, [RecordedText { step: 2, text: "low".to_owned() }]);
    assert!(!is_torn);
}

#[test]
fn samples_in_another_encoding_are_refused_by_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    fs::write(&path, written("protobuf")).expect("a file");
    let error = Samples::read(&path).expect_err("an encoding of others").to_string();
    assert_eq!(error, "topic /step is encoded as protobuf; this version of lashloop reads cdr and ros1");
}
