//! What a loss of power leaves.

use std::fs;
use std::path::Path;

use lashloop_firmware::store::{BLANK, LINE_WORDS, PAIRS_MAX, Progress, SECTOR_LINES, Store, StoreError};

use crate::flash::{Cells, ERASE_INSTANTS, Flash};

/// Parameters of a set.
const COUNT: usize = 101;
/// Slots of a sector.
const SLOTS: u32 = 64;

fn value(set: u32, at: usize) -> u32 {
    set.wrapping_mul(0x0101_0101) ^ at as u32
}

/// Stores a set of parameters that are named by their places.
fn keep(store: &mut Store, set: u32) -> Result<(), StoreError> {
    store.begin(COUNT)?;
    loop {
        match store.step(|at| [0x1000 + at as u32, value(set, at)]) {
            Progress::Writing => {}
            Progress::Done(result) => return result,
            Progress::Idle => panic!("a store that has begun isn't idle"),
        }
    }
}

/// The set of a store; `None` without one.
///
/// # Panics
/// It is a mixture.
fn set_of(store: &Store) -> Option<u32> {
    let first = store.word(0x1000, 0)?;
    for at in 0..COUNT {
        let word = store.word(0x1000 + at as u32, 0).expect("a whole set");
        assert_eq!(word, value(first / 0x0101_0101, at), "a mixture at {at}");
    }
    Some(first / 0x0101_0101)
}

/// Cells in which these sets were stored, with a power-up after each `sets_per_boot`.
fn cells_with(has_code: bool, sets: u32, sets_per_boot: u32) -> Cells {
    let mut cells = Cells::blank(has_code);
    let mut set = 0;
    while set < sets {
        let flash = Flash::new(cells);
        let mut store = Store::open(flash);
        for _ in 0..sets_per_boot.min(sets - set) {
            set += 1;
            assert_eq!(keep(&mut store, set), Ok(()));
        }
        cells = flash.take();
    }
    cells
}

/// Stores a further set and cuts the power after some instants, the start included. Returns the cells, and whether it was cut.
fn cut_at(cells: &Cells, set: u32, instants: u32) -> (Cells, bool) {
    let flash = Flash::new(cells.cut_after(instants, u64::from(instants) + 1));
    let mut store = Store::open(flash);
    // What it answers reaches nobody.
    let _ = keep(&mut store, set);
    let cells = flash.take();
    let was_cut = cells.is_dead;
    (cells.powered(), was_cut)
}

/// Sets stored before the cut, and how many of them at each power-up: a new memory; one set; a sector that has one slot; one that is
/// full, with the other one blank or to be erased.
const HISTORIES: [(u32, u32); 6] = [(0, 1), (1, 1), (63, 63), (64, 64), (128, 64), (130, 1)];

#[test]
fn a_power_cut_leaves_the_old_or_the_new_set() {
    let (mut cuts, mut kept, mut replaced, mut erasing) = (0, 0, 0, 0);
    for (has_code, (sets, sets_per_boot)) in
        [false, true].into_iter().flat_map(|it| HISTORIES.map(|h| (it, h)))
    {
        let before = cells_with(has_code, sets, sets_per_boot);
        let (old, new) = ((sets > 0).then_some(sets), sets + 1);
        for instants in 0.. {
            let (after, was_cut) = cut_at(&before, new, instants);
            if !was_cut {
                break;
            }
            cuts += 1;
            erasing += u32::from(sets == 128 && instants < ERASE_INSTANTS);
            let flash = Flash::new(after);
            let mut store = Store::open(flash);
            let found = set_of(&store);
            assert!(found == old || found == Some(new), "{found:?} after {sets} sets, cut at {instants}");
            kept += u32::from(found == old);
            replaced += u32::from(found == Some(new));
            // Not bricked: it stores again, at the latest after a power-up.
            let mut again = keep(&mut store, 200);
            if again == Err(StoreError::Full) {
                store = Store::open(Flash::new(flash.take().powered()));
                again = keep(&mut store, 200);
            }
            assert_eq!((again, set_of(&store)), (Ok(()), Some(200)), "{sets} sets, cut at {instants}");
            flash.take();
        }
    }
    assert!(
        cuts >= 1_000 && erasing >= 20 && kept > 0 && replaced > 0,
        "{cuts}, {erasing}, {kept}, {replaced}"
    );
    report(&format!(
        "{cuts} cuts of the power during a store: {kept} left the old set, {replaced} the new one, 0 a mixture, 0 no working store\n"
    ));
}

/// Writes a line for the end of the whole test command.
fn report(line: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/reports");
    fs::create_dir_all(&folder).expect("a folder for reports");
    fs::write(folder.join("store.txt"), line).expect("a report");
}

#[test]
fn a_cut_while_a_cut_is_repaired_loses_nothing() {
    let before = cells_with(true, 128, 64);
    for first in (0..ERASE_INSTANTS).step_by(3) {
        let (once, _) = cut_at(&before, 129, first);
        for second in 0..ERASE_INSTANTS {
            let (twice, was_cut) = cut_at(&once, 129, second);
            assert!(was_cut);
            assert_eq!(set_of(&Store::open(Flash::new(twice))), Some(128), "{first}, {second}");
        }
    }
}

#[test]
fn a_sector_is_erased_once_in_64_stores_and_only_at_power_up() {
    let flash = Flash::new(Cells::blank(true));
    let mut store = Store::open(flash);
    for set in 1..=2 * SLOTS {
        assert_eq!(keep(&mut store, set), Ok(()));
    }
    assert_eq!(keep(&mut store, 129), Err(StoreError::Full));
    assert_eq!((set_of(&store), flash.cells().erasures), (Some(128), 0));
    let flash = Flash::new(flash.take());
    let mut store = Store::open(flash);
    assert_eq!((set_of(&store), flash.cells().erasures), (Some(128), 1));
    for set in 129..129 + SLOTS {
        assert_eq!(keep(&mut store, set), Ok(()));
    }
    assert_eq!(keep(&mut store, 250), Err(StoreError::Full));
}

#[test]
fn a_new_memory_is_not_erased_and_one_of_other_contents_works() {
    let flash = Flash::new(Cells::blank(true));
    let _ = Store::open(flash);
    assert_eq!(flash.cells().erasures, 0);
    let mut others = Cells::blank(false);
    for line in 0..2 * SECTOR_LINES {
        for at in 0..LINE_WORDS {
            others.lines[line][at] = others.random();
        }
    }
    let flash = Flash::new(others);
    let mut store = Store::open(flash);
    assert_eq!((set_of(&store), keep(&mut store, 3), set_of(&store)), (None, Ok(()), Some(3)));
}

#[test]
fn a_changed_bit_of_a_record_makes_the_one_before_count() {
    let before = cells_with(false, 2, 2);
    let lines = SECTOR_LINES / 64..SECTOR_LINES / 64 + 1 + COUNT.div_ceil(LINE_WORDS / 2);
    for (line, bit) in lines.clone().flat_map(|line| (0..256).step_by(7).map(move |bit| (line, bit))) {
        let mut cells = before.powered();
        // What follows the check value in the first line is unused.
        if line == lines.start && bit >= 128 {
            continue;
        }
        cells.lines[line][bit / 32] ^= 1 << (bit % 32);
        assert_eq!(set_of(&Store::open(Flash::new(cells))), Some(1), "line {line}, bit {bit}");
    }
}

#[test]
fn a_memory_that_refuses_to_be_written_keeps_what_it_has() {
    let mut cells = cells_with(true, 1, 1);
    cells.refuses = true;
    let mut store = Store::open(Flash::new(cells));
    assert_eq!((keep(&mut store, 2), set_of(&store)), (Err(StoreError::Refused), Some(1)));
    assert!(!store.is_writing());
}

#[test]
fn a_record_has_room_for_every_parameter_of_the_protocol() {
    let mut store = Store::open(Flash::new(Cells::blank(true)));
    const { assert!(PAIRS_MAX >= 240) };
    assert_eq!(store.begin(PAIRS_MAX), Ok(()));
    while store.step(|at| [at as u32, !(at as u32)]) == Progress::Writing {}
    assert_eq!(store.word(PAIRS_MAX as u32 - 1, 7), Some(!(PAIRS_MAX as u32 - 1)));
    assert_ne!(BLANK[0], 0);
}
