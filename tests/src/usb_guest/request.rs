//! The messages between a test and the guest's agent: one line of JSON each.

use serde::{Deserialize, Serialize};

/// Where the guest lists the ports of virtio, of which it has one: the channel.
pub const PORTS: &str = "/sys/class/virtio-ports";
/// Where the guest has the workspace, and the folder of the programs under test.
pub const WORKSPACE: &str = "/workspace";
/// Where the guest has the folder of the programs under test.
pub const PROGRAMS: &str = "/programs";

/// A message with the number of its request. A test that has given a request up discards the answer to it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Numbered<T> {
    /// The number of the request, from 1 on; [`UNASKED`] for an answer that no request asked for.
    pub number: u32,
    /// The message.
    pub message: T,
}

/// Number of an answer that no request asked for.
pub const UNASKED: u32 = 0;

/// A command in the guest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Line {
    /// Program and arguments.
    pub words: Vec<String>,
    /// Who runs it.
    pub user: User,
}

/// Who runs a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum User {
    /// Root.
    Root,
    /// A user in the group `dialout`, who may open serial ports.
    Member,
}

/// What a test requests.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request {
    /// Starts a command.
    Start(Line),
    /// Waits for its end; kills it after the limit.
    Wait {
        /// Number of the command.
        command: u32,
        /// Time, in seconds.
        limit_s: u32,
    },
    /// Kills a command.
    Kill {
        /// Number of the command.
        command: u32,
    },
    /// Reads a file.
    Read {
        /// Its path.
        path: String,
    },
    /// Writes a file.
    Write {
        /// Its path.
        path: String,
        /// Its contents.
        text: String,
    },
    /// Removes a folder, if it exists.
    RemoveFolder {
        /// Its path.
        path: String,
    },
    /// Waits until a file exists, or doesn't, and udev has served its events.
    Await {
        /// Its path.
        path: String,
        /// Whether it is to exist.
        exists: bool,
    },
    /// Switches the guest off.
    PowerOff,
}

/// What the agent answers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer {
    /// The guest is up; the agent sends this once, unasked.
    Up,
    /// A second of the guest's clock has passed; unasked too.
    Second,
    /// Number of the started command.
    Started(u32),
    /// A command has ended.
    Ended {
        /// Exit code; `None` after a signal.
        code: Option<i32>,
        /// Standard output.
        stdout: String,
        /// Standard error.
        stderr: String,
    },
    /// Contents of a file.
    Text(String),
    /// The request is fulfilled.
    Done,
    /// Why it can't be.
    Failed(String),
}
