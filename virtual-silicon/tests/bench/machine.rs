//! A machine in a thread of its own, to which a test sends commands.

use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};

use lashloop_silicon::machine::{self, Ended};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::wiring::Wiring;

use crate::bench::{Command, Site};

/// A chip that runs an image on a board.
pub struct Machine {
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
            // A test that waits for an answer would wait forever.
            ended.surroundings.close();
            ended
        });
        Self { commands, thread }
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
