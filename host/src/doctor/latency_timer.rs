//! The latency timer of a USB adapter. The adapter holds received bytes until a packet is full or the timer expires. FTDI
//! adapters default to 16 ms, the time of a dozen lockstep steps.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The timers in sysfs.
const DEVICES: &str = "/sys/bus/usb-serial/devices";
const SHORTEST_MS: u32 = 1;

/// A latency timer, after the attempt to shorten it.
#[derive(Debug)]
pub enum LatencyTimer {
    /// The driver has none: USB CDC and ports that are not on USB.
    None,
    Short,
    Shortened {
        from_ms: u32,
    },
    /// Long, and the system refuses to shorten it.
    Long {
        ms: u32,
        file: PathBuf,
        reason: io::Error,
    },
}

impl LatencyTimer {
    /// Sets the timer of a terminal to its minimum.
    #[must_use]
    pub fn shorten(terminal: &Path) -> Self {
        Self::shorten_in(Path::new(DEVICES), terminal)
    }

    fn shorten_in(devices: &Path, terminal: &Path) -> Self {
        let terminal = terminal.canonicalize().unwrap_or_else(|_| terminal.to_owned());
        let Some(name) = terminal.file_name() else { return Self::None };
        let file = devices.join(name).join("latency_timer");
        let read = || fs::read_to_string(&file).ok()?.trim().parse::<u32>().ok();
        let Some(ms) = read() else { return Self::None };
        if ms <= SHORTEST_MS {
            return Self::Short;
        }
        match fs::write(&file, SHORTEST_MS.to_string()) {
            Ok(()) if read() == Some(SHORTEST_MS) => Self::Shortened { from_ms: ms },
            Ok(()) => Self::Long { ms, file, reason: io::Error::other("the driver keeps its value") },
            Err(reason) => Self::Long { ms, file, reason },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn devices(timer: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("ttyUSB9")).unwrap();
        fs::write(folder.path().join("ttyUSB9/latency_timer"), timer).unwrap();
        folder
    }

    #[test]
    fn long_timer_is_shortened_to_1_ms_and_reported() {
        let folder = devices("16\n");
        let timer = LatencyTimer::shorten_in(folder.path(), Path::new("/dev/ttyUSB9"));
        assert!(matches!(timer, LatencyTimer::Shortened { from_ms: 16 }), "{timer:?}");
        assert_eq!(fs::read_to_string(folder.path().join("ttyUSB9/latency_timer")).unwrap(), "1");
    }

    #[test]
    fn short_timer_is_not_written() {
        let folder = devices("1\n");
        let timer = LatencyTimer::shorten_in(folder.path(), Path::new("/dev/ttyUSB9"));
        assert!(matches!(timer, LatencyTimer::Short), "{timer:?}");
        assert_eq!(fs::read_to_string(folder.path().join("ttyUSB9/latency_timer")).unwrap(), "1\n");
    }

    #[test]
    fn a_driver_without_a_timer_has_none() {
        let timer = LatencyTimer::shorten_in(devices("16").path(), Path::new("/dev/ttyACM0"));
        assert!(matches!(timer, LatencyTimer::None), "{timer:?}");
    }
}
