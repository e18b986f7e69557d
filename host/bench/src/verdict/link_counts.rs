//! Counters of the link.

use serde::Serialize;

/// Counters of the link during a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct LinkCounts {
    /// Frames sent to the drive.
    pub frames_sent: u64,
    /// Valid frames received from the drive.
    pub frames_received: u64,
    /// Frames rejected for their checksum.
    pub crc_errors: u64,
    /// Steps without an answer.
    pub lost: u64,
    /// Steps whose answer arrived late.
    pub late: u64,
    /// Times that a lost drive came back and the run resumed.
    pub resumes: u64,
    /// Damaged frames, as counted by the drive.
    pub damaged_at_drive: u64,
    /// Bytes lost to receiver overruns, as counted by the drive.
    pub overruns_at_drive: u64,
}
