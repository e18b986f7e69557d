//! The image as `lashloop flash` writes it.

use lashloop_hardware::flash::Image;
use tests::program;
use tests::records::Records;

/// The bytes for the flash, without the ELF, start as the drive, and it reports the build that the ELF has.
pub(crate) fn bytes_boot() {
    let elf = tests::workspace().join("target/lashloop-firmware.elf");
    let image = Image::read(&elf).expect("an image");
    let build = image.build.expect("the linker script has the build").commit.expect("a commit");
    let records = Records::new();
    let bytes = records.path("image.bin");
    std::fs::write(&bytes, &image.bytes).expect("the bytes");
    let ended = program::run(["doctor", &format!("qemu:{}", bytes.display())]).with_code(0);
    assert!(ended.stdout.contains(&format!("build {build:08x}")), "{}", ended.stdout);
}
