//! Faults of the drive itself.

use super::kinds::fault_kinds;

fault_kinds! {
    /// Faults of the drive itself.
    pub enum DeviceFault {
        /// The drive restarts, as after a short loss of power.
        "device-reset" => Reset lasts Momentary {}
        /// The drive is suspended, and resumes when the fault ends.
        "device-hang" => Hang lasts WallClock {}
    }
}
