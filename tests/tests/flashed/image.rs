//! ELF files as images.

use std::fs;

use lashloop_bench::device::Build;
use lashloop_hardware::flash::Image;
use lashloop_hardware::flash::image::ImageProblem;
use tests::elf::Elf;

use crate::bench::Workbench;

/// The image of an ELF.
fn read(elf: Elf) -> Result<Image, ImageProblem> {
    Image::read(&Workbench::with(elf).image()).map_err(|error| error.problem)
}

pub(crate) fn gaps() {
    let mut elf = Elf::image(101, 0xc0ff_ee00, true);
    // Out of order, as a linker may write them; without contents, as variables that start at zero.
    elf.segments.insert(0, (0x0800_0070, vec![1, 2, 3]));
    elf.segments.push((0x2000_0000, Vec::new()));
    let image = read(elf.clone()).expect("an image");
    let want = [&elf.segments[1].1[..], &[0xff; 0x70 - 101], &[1, 2, 3]].concat();
    assert_eq!(image.bytes, want);
    let build = Build { commit: 0xc0ff_ee00.try_into().ok(), is_dirty: true };
    assert_eq!((image.build, image.board.as_deref()), (Some(build), Some("native-twin")));
}

pub(crate) fn beyond() {
    let mut elf = Elf::image(100, 1, false);
    elf.segments.push((0x080f_fffe, vec![0; 2]));
    assert_eq!(read(elf.clone()).expect("an image that fills the flash").bytes.len(), 1 << 20);
    for (address, size) in [(0x080f_fffe, 3), (0x2000_0000, 1), (0xffff_ffff, 2)] {
        elf.segments[1] = (address, vec![0; size]);
        let problem = read(elf.clone()).expect_err("bytes outside the flash");
        assert!(matches!(problem, ImageProblem::Outside { address: at, .. } if at == address), "{problem}");
    }
}

pub(crate) fn elsewhere() {
    let mut elf = Elf::image(100, 1, false);
    elf.segments[0].0 = 0x0800_4000;
    let problem = read(elf).expect_err("an image behind a boot loader of its own");
    assert!(matches!(problem, ImageProblem::Begin { address: 0x0800_4000 }), "{problem}");
}

pub(crate) fn no_drive() {
    let mut elf = Elf::image(100, 1, false);
    elf.symbols.push(("_lashloop_no_drive", 1));
    assert!(matches!(read(elf), Err(ImageProblem::NoDrive)));
}

pub(crate) fn no_vectors() {
    // Stack in the flash; reset vector beyond the image; reset vector of the Arm state; no vectors at all.
    for (at, word) in [(0, 0x0800_0000), (4, 0x0800_0101), (4, 0x0800_0008), (0, 0xffff_ffff_u32)] {
        let mut elf = Elf::image(0x100, 1, false);
        elf.segments[0].1[at..at + 4].copy_from_slice(&word.to_le_bytes());
        let problem = read(elf).expect_err("wrong vectors");
        assert!(matches!(problem, ImageProblem::Vectors { .. }), "{problem}");
    }
    let mut short = Elf::image(8, 1, false);
    short.segments[0].1.truncate(7);
    assert!(matches!(read(short), Err(ImageProblem::Vectors { .. })));
}

pub(crate) fn no_elf() {
    let bench = Workbench::new();
    let whole = bench.elf.bytes();
    let problem = |bytes: &[u8]| {
        fs::write(bench.image(), bytes).expect("a file");
        Image::read(&bench.image()).expect_err("no image").problem
    };
    for bytes in [&b""[..], b"lashloop", &whole[..60], &whole[..100]] {
        let problem = problem(bytes);
        assert!(matches!(problem, ImageProblem::NotAnElf(_)), "{problem}");
    }
    let x86 = Elf { machine: 3, ..bench.elf.clone() };
    assert!(matches!(problem(&x86.bytes()), ImageProblem::NotAnElf(_)));
    let empty = Elf { segments: Vec::new(), ..bench.elf.clone() };
    assert!(matches!(problem(&empty.bytes()), ImageProblem::Empty));
    fs::remove_file(bench.image()).expect("a file");
    let missing = bench.flash_with(&[]).with_code(2).stderr;
    assert!(missing.contains("image.elf: can't be read") && !missing.contains("qemu"), "{missing}");
    fs::write(bench.image(), "no ELF").expect("a file");
    let ended = bench.flash_with(&["--device", "/dev/pts/0"]).with_code(2);
    assert!(ended.stderr.contains("`cargo xtask image`"), "{}", ended.stderr);
}
