use std::fs;

use super::*;

const SHORTEST: &str = "title = \"t\"\ncontact = \"c\"\nboard = \"b\"\n[port]\ndevice = \"/dev/serial/by-id/x\"\n\
                        [limits]\ntorque_nm = 5.0\nload_travel_rad = 4.0\n";

fn document(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn page_and_schema_list_the_keys_of_the_reader() {
    assert!(
        document("rig.md").trim_end() == Rig::page().trim_end(),
        "stale: lashloop rig keys > docs/rig.md"
    );
    let schema: serde_json::Value = serde_json::from_str(&document("rig.schema.json")).unwrap();
    assert!(schema == Rig::json_schema(), "stale: lashloop rig keys --schema > docs/rig.schema.json");
}

#[test]
fn the_example_of_the_documents_is_a_rig() {
    let page = document("using-a-rig.md");
    let example =
        page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let rig = Rig::from_str("rig.toml", example).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(rig.encoders.load_direction, Some(Direction::Reversed));
    assert_eq!(rig.loader.via, Some(Way::Dfu));
    // The amplifier gives the torque that the limits allow.
    let stage = rig.power_stage;
    let [scale_nm, max] = [stage.torque_per_duty_nm, stage.duty_max].map(|it| it.expect("in the example"));
    assert!(scale_nm * (max - 0.5) >= rig.limits.torque_nm);
}

#[test]
fn duties_in_the_wrong_order_are_rejected_with_the_defaults_of_the_drive() {
    let stage = |text: &str| Rig::from_str("rig.toml", &format!("{SHORTEST}[power_stage]\n{text}\n"));
    assert!(stage("duty_offset = 0.1").is_ok());
    for wrong in ["duty_offset = 0.02", "duty_offset = 0.91", "duty_min = 0.51", "duty_max = 0.4"] {
        let error = stage(wrong).expect_err(wrong).to_string();
        assert!(error.contains("power_stage") && error.contains("defaults of the drive included"), "{error}");
    }
    let error = stage("duty_offset = 0.02").expect_err("below 0.1").to_string();
    assert!(error.contains("duty_min = 0.1, duty_offset = 0.02, duty_max = 0.9"), "{error}");
}

#[test]
fn a_simulator_is_no_rig() {
    for device in ["inproc", "native", "qemu:a.elf", "silicon", "exec:./drive"] {
        let error = Rig::from_str("rig.toml", &SHORTEST.replace("/dev/serial/by-id/x", device));
        let error = error.expect_err(device).to_string();
        assert!(error.contains("port.device") && error.contains("is a simulator"), "{error}");
    }
    for device in ["tcp:bench2:4000", "rfc2217:bench2:2217"] {
        Rig::from_str("rig.toml", &SHORTEST.replace("/dev/serial/by-id/x", device)).expect(device);
    }
}

#[test]
fn an_absent_section_leaves_the_defaults_of_the_drive() {
    let rig = Rig::from_str("rig.toml", SHORTEST).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!((rig.encoders, rig.power_stage), (Encoders::default(), PowerStage::default()));
    assert_eq!((rig.port.baud, rig.loader), (BAUD, Loader::default()));
}

#[test]
fn every_error_of_a_file_is_reported_with_its_line() {
    let wrong = SHORTEST
        .replace("torque_nm = 5.0", "torque_nm = 0.0")
        .replace("contact = \"c\"\n", "")
        .replace("/dev/serial/by-id/x", "/dev/ttyACM0")
        + "[power_stage]\ntorque_per_duty_nm = 0\nduty_mn = 0.1\n[loader]\nvia = \"jtag\"\n";
    let errors = Rig::from_str("rig.toml", &wrong).expect_err("a faulty file").to_string();
    insta::assert_snapshot!(errors);
}
