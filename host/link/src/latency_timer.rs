//! The latency timer of a USB adapter. The adapter holds received bytes until a packet is full or the timer expires. FTDI
//! adapters default to 16 ms, the time of a dozen lockstep steps, and return to it when they are unplugged.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The timers in sysfs.
const DEVICES: &str = "/sys/bus/usb-serial/devices";
/// The shortest time that FTDI specifies.
const SHORTEST_MS: u32 = 1;

/// The rule for udev that shortens the timer of every FTDI adapter when it is plugged in.
pub const UDEV_RULE: &str = include_str!("90-ftdi-latency.rules").trim_ascii_end();

/// A latency timer, after the attempt to shorten it.
#[derive(Debug)]
pub enum LatencyTimer {
    /// The driver has none: USB CDC and ports that are not on USB.
    None,
    /// Short already.
    Short {
        /// Its value: 1, or 0, which a driver may report though FTDI doesn't specify it.
        ms: u32,
    },
    /// It was long and is now 1 ms.
    Shortened {
        /// The value before.
        from_ms: u32,
    },
    /// Long, and the system refuses to shorten it.
    Long {
        /// Its value.
        ms: u32,
        /// The file in sysfs that sets it.
        file: PathBuf,
        /// Why it can't be written.
        reason: io::Error,
    },
}

impl LatencyTimer {
    /// Sets the timer of a terminal to its minimum.
    #[must_use]
    pub fn shorten(terminal: &Path) -> Self {
        Self::shorten_in(Path::new(DEVICES), terminal)
    }

    /// The timer of a terminal in ms; `None` for a driver without one.
    #[must_use]
    pub fn read_ms(terminal: &Path) -> Option<u32> {
        read_ms(&file_in(Path::new(DEVICES), terminal)?)
    }

    /// The same timer after an opening of the port shortened it, with the value of before.
    #[must_use]
    pub fn since(self, before_ms: Option<u32>) -> Self {
        match (self, before_ms) {
            (Self::Short { .. }, Some(from_ms)) if from_ms > SHORTEST_MS => Self::Shortened { from_ms },
            (timer, _) => timer,
        }
    }

    fn shorten_in(devices: &Path, terminal: &Path) -> Self {
        let Some(file) = file_in(devices, terminal) else { return Self::None };
        let Some(ms) = read_ms(&file) else { return Self::None };
        if ms <= SHORTEST_MS {
            return Self::Short { ms };
        }
        match fs::write(&file, SHORTEST_MS.to_string()) {
            Ok(()) if read_ms(&file) == Some(SHORTEST_MS) => Self::Shortened { from_ms: ms },
            Ok(()) => Self::Long { ms, file, reason: io::Error::other("the driver keeps its value") },
            Err(reason) => Self::Long { ms, file, reason },
        }
    }

    /// What to do about a timer that stays long; `None` for any other.
    #[must_use]
    pub fn remedy(&self) -> Option<String> {
        let Self::Long { ms, file, reason } = self else { return None };
        Some(format!(
            "{ms} ms and can't be shortened ({reason}): echo 1 | sudo tee {}, or for every reconnect a file in \
             /etc/udev/rules.d with the line {UDEV_RULE}",
            file.display()
        ))
    }
}

fn file_in(devices: &Path, terminal: &Path) -> Option<PathBuf> {
    let terminal = terminal.canonicalize().unwrap_or_else(|_| terminal.to_owned());
    Some(devices.join(terminal.file_name()?).join("latency_timer"))
}

fn read_ms(file: &Path) -> Option<u32> {
    fs::read_to_string(file).ok()?.trim().parse().ok()
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
        assert!(matches!(timer, LatencyTimer::Short { ms: 1 }), "{timer:?}");
        assert_eq!(fs::read_to_string(folder.path().join("ttyUSB9/latency_timer")).unwrap(), "1\n");
    }

    #[test]
    fn a_driver_without_a_timer_has_none() {
        let timer = LatencyTimer::shorten_in(devices("16").path(), Path::new("/dev/ttyACM0"));
        assert!(matches!(timer, LatencyTimer::None), "{timer:?}");
    }
    #[test]
    fn a_timer_of_zero_is_reported_as_zero() {
        let folder = devices("0\n");
        let timer = LatencyTimer::shorten_in(folder.path(), Path::new("/dev/ttyUSB9"));
        assert!(matches!(timer, LatencyTimer::Short { ms: 0 }), "{timer:?}");
    }

    #[test]
    fn a_timer_that_an_opening_shortened_has_its_former_value() {
        let short = || LatencyTimer::Short { ms: 1 };
        assert!(matches!(short().since(Some(16)), LatencyTimer::Shortened { from_ms: 16 }));
        assert!(matches!(short().since(Some(1)), LatencyTimer::Short { ms: 1 }));
        assert!(matches!(short().since(None), LatencyTimer::Short { ms: 1 }));
        assert!(matches!(LatencyTimer::None.since(Some(16)), LatencyTimer::None));
    }

    #[test]
    fn a_timer_that_stays_long_has_command_and_rule_as_remedy() {
        let timer = LatencyTimer::Long {
            ms: 16,
            file: "/sys/x/latency_timer".into(),
            reason: io::ErrorKind::PermissionDenied.into(),
        };
        let remedy = timer.remedy().expect("a remedy");
        assert!(remedy.contains("sudo tee /sys/x/latency_timer") && remedy.contains(UDEV_RULE), "{remedy}");
        assert_eq!(LatencyTimer::Shortened { from_ms: 16 }.remedy(), None);
    }
}
