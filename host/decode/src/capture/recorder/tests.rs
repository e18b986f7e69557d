use super::*;
use crate::capture::{pcapng, reader};

fn packets(path: &Path) -> Vec<Vec<u8>> {
    let bytes = std::fs::read(path).unwrap();
    reader::packets(&bytes).map(|packet| packet.expect("whole").bytes.clone()).collect()
}

#[test]
fn packets_reach_the_file_by_themselves_and_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("line.pcapng");
    let (mut recorder, capture) = create(&path, WhenFull::Fail).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), pcapng::file_header());
    recorder.push(Direction::HostToDrive, &[1, 2, 0]);
    let deadline = Instant::now() + Duration::from_secs(10);
    while packets(&path).is_empty() {
        assert!(Instant::now() < deadline, "nothing is written while the line is silent");
        thread::sleep(Duration::from_millis(1));
    }
    recorder.push(Direction::DriveToHost, &[1, 0]);
    drop(recorder);
    assert_eq!(packets(&path), [&[1, 2, 0][..], &[1, 0]], "the last one is written at the end");
    assert_eq!(capture.finish().unwrap(), 2);
}

#[test]
fn a_line_faster_than_the_disk_waits_in_lockstep() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("line.pcapng");
    let (mut recorder, capture) = with_capacity(&path, WhenFull::Wait, 256).unwrap();
    let frames: Vec<[u8; 4]> = (0..2_000_u32).map(u32::to_le_bytes).collect();
    frames.iter().for_each(|frame| recorder.push(Direction::HostToDrive, frame));
    drop(recorder);
    assert_eq!(capture.finish().unwrap(), 2_000);
    assert_eq!(packets(&path), frames);
}

#[test]
fn a_gap_is_an_error_and_nothing_stands_behind_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("line.pcapng");
    let (mut recorder, capture) = with_capacity(&path, WhenFull::Fail, 64).unwrap();
    capture.check().expect("no packet yet");
    recorder.push(Direction::HostToDrive, &[1, 0]);
    recorder.push(Direction::HostToDrive, &[2; 100]);
    thread::sleep(4 * FLUSH);
    recorder.push(Direction::HostToDrive, &[3, 0]);
    let error = capture.check().expect_err("a packet did not fit");
    assert!(error.path == path && error.to_string().contains("behind the line"), "{error}");
    drop(recorder);
    assert!(capture.finish().is_err(), "the error stays");
    assert_eq!(packets(&path), [[1, 0]]);
}

#[test]
fn a_full_disk_is_reported_by_the_path() {
    let error = create(Path::new("/dev/full"), WhenFull::Fail).expect_err("it takes nothing");
    assert_eq!((error.path.as_path(), error.action), (Path::new("/dev/full"), "written"));
}
