//! Machines, which tests use one after the other.
//!
//! The processor's model translates an image while it runs, and that takes most of the time of a short run. A reset of the
//! chip keeps the translation, so a test takes over the machine of an earlier test with the same image.

use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use lashloop_silicon::machine::{self, Ended};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::wiring::Wiring;

use crate::bench::{Command, Site};

/// Machines that no test uses.
static IDLE: Mutex<Vec<Machine>> = Mutex::new(Vec::new());

/// Most of them: each holds its translation, some 100 MB.
const MOST_IDLE: usize = 4;

/// A chip that runs an image on a board.
pub struct Machine {
    image: Symbols,
    commands: Sender<Command>,
    thread: JoinHandle<Ended<Site>>,
}

impl Machine {
    /// Powers a chip up. `site` gets the commands of the test.
    pub fn power_up(image: &Symbols, wiring: Wiring, site: impl FnOnce(Receiver<Command>) -> Site) -> Self {
        let (commands, receiver) = mpsc::channel();
        let (site, placed) = (site(receiver), image.image().expect("an image"));
        let thread = thread::spawn(move || {
            let mut ended = machine::run(placed, wiring, site).expect("the image runs");
            // A test that waits for an answer would wait for ever.
            ended.surroundings.close();
            ended
        });
        Self { image: image.clone(), commands, thread }
    }

    /// A machine that an earlier test has left.
    pub fn take_over(image: &Symbols) -> Option<Self> {
        let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
        let place = idle.iter().position(|it| it.image == *image)?;
        Some(idle.remove(place))
    }

    /// Leaves the machine to a later test.
    pub fn leave(self) {
        let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
        idle.push(self);
        if idle.len() > MOST_IDLE {
            // The one that has waited longest ends once its commands do.
            idle.remove(0);
        }
    }

    /// Whether the machine has taken the command; one that has ended takes none.
    pub fn send(&self, command: Command) -> bool {
        self.commands.send(command).is_ok()
    }

    /// Ends the machine after its last command.
    pub fn end(self) -> Ended<Site> {
        drop(self.commands);
        self.thread.join().expect("the machine didn't panic")
    }
}
