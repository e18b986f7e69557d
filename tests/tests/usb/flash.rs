//! A boot loader whose adapter is unplugged during `lashloop flash`.

use tests::usb_guest::guest::Ended;

use crate::machine::{Device, Kind, Machine, Unplug};

const IMAGE: &str = "/tmp/image.elf";

fn flash_until(machine: &mut Machine, bytes: usize, delay_us: u32) -> Ended {
    let image = machine.start_own(&["image", IMAGE]);
    let _ = machine.wait(image).with_code(0);
    let unplug = Unplug::After { bytes, delay_us };
    let mut device = Device::plug_until(machine, Kind::Loader, "LASHF1", unplug);
    let port = Kind::Loader.stable_name("LASHF1");
    let board = ["--board", "native-twin"];
    let flash = [&["flash", IMAGE, "--via", "uart", "--device", &port], &board[..]].concat();
    let ended = device.machine.lashloop(&flash).with_code(4);
    device.await_unplug();
    assert!(!ended.stdout.contains("flashed "), "{}", ended.stdout);
    ended
}

pub(crate) fn before_the_first_block(machine: &mut Machine) {
    let ended = flash_until(machine, 1, 0);
    assert!(ended.stderr.contains("no way onto the chip"), "{}", ended.stderr);
    assert!(ended.stderr.contains("stm32flash failed, exit status: 1, "), "{}", ended.stderr);
}

pub(crate) fn between_blocks(machine: &mut Machine) {
    let ended = flash_until(machine, 5_000, 0);
    assert!(ended.stderr.contains("not flashed: stm32flash failed"), "{}", ended.stderr);
    assert!(ended.stderr.contains("hold BOOT0 high during a reset and call again"), "{}", ended.stderr);
}

pub(crate) fn after_the_start(machine: &mut Machine) {
    let ended = flash_until(machine, usize::MAX, 100_000);
    assert!(ended.stderr.contains("written and compared, but not confirmed"), "{}", ended.stderr);
}
