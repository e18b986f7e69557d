//! The walks to a board and to an image of one's own.

use std::process::Command;

use tests::program;

/// The page about an image of one's own in C.
pub(crate) fn image_in_c() {
    tests::walk::through("docs/extend/drive-in-c-on-a-board.md", &[]);
}

/// The image of that page against the protocol. A busy machine leaves checks of time without a judgement.
pub(crate) fn image_in_c_conforms() {
    let folder = tempfile::tempdir().expect("a folder");
    let image = folder.path().join("nucleo.elf").display().to_string();
    let make = Command::new("make")
        .args(["-s", "-B", "-C", "examples/drive-in-c/nucleo", &format!("DRIVE={image}")])
        .current_dir(tests::workspace())
        .output()
        .expect("make starts");
    assert!(make.status.success(), "{}", String::from_utf8_lossy(&make.stderr));
    let ended = program::run(["conformance", "--device", &format!("silicon:{image}")]);
    let last = ended.stdout.lines().last().unwrap_or_default();
    let passed = last.split(' ').next().and_then(|count| count.parse::<usize>().ok());
    assert!(last.contains(" passed, 0 failed, ") && passed.is_some_and(|it| it > 185), "{}", ended.stdout);
}

/// The page leads there; its last command is a run that fails at a wrong wire.
pub(crate) fn own_board() {
    tests::walk::through_in_a_copy("docs/extend/board.md");
}
