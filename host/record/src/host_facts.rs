//! The computer that ran the bench, as far as it can change timing or bits.

use std::fs;

use serde::{Deserialize, Serialize};

/// Facts of the host. `None` is what the system does not report.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HostFacts {
    /// Release of the kernel.
    pub kernel: String,
    /// Model of the first processor; where the kernel does not name it, as on ARM, its implementer and part, or the board.
    pub cpu: Option<String>,
    /// Processors that the program may use.
    pub cores: usize,
    /// Frequency governor of the first processor.
    pub governor: Option<String>,
    /// The kernel's clock source.
    pub clock_source: Option<String>,
}

impl HostFacts {
    /// Those of this computer.
    #[must_use]
    pub fn read() -> Self {
        let line = |path| fs::read_to_string(path).ok().map(|text| text.trim().to_owned());
        let cpus = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        // The text ends with a zero.
        let board = || line("/proc/device-tree/model").map(|text| text.trim_end_matches('\0').to_owned());
        Self {
            kernel: rustix::system::uname().release().to_string_lossy().into_owned(),
            cpu: processor(&cpus).or_else(board),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            governor: line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
            clock_source: line("/sys/devices/system/clocksource/clocksource0/current_clocksource"),
        }
    }
}

/// The first processor of `/proc/cpuinfo`: on x86 by its model, on ARM by the codes of implementer and part.
fn processor(cpus: &str) -> Option<String> {
    let entry = |wanted: &str| {
        let mut entries = cpus.lines().filter_map(|line| line.split_once(':'));
        entries.find(|(key, _)| key.trim() == wanted).map(|(_, value)| value.trim().to_owned())
    };
    let of_arm = || Some(format!("implementer {} part {}", entry("CPU implementer")?, entry("CPU part")?));
    entry("model name").or_else(of_arm)
}

#[cfg(test)]
mod tests {
    use super::processor;

    #[test]
    fn a_processor_has_a_name_on_x86_and_codes_on_arm() {
        let of = |text| processor(text).unwrap_or_default();
        assert_eq!(of("processor\t: 0\nmodel\t\t: 85\nmodel name\t: Some CPU @ 2 GHz\n"), "Some CPU @ 2 GHz");
        let arm = "processor\t: 0\nCPU implementer\t: 0x41\nCPU variant\t: 0x0\nCPU part\t: 0xd08\n";
        assert_eq!(of(arm), "implementer 0x41 part 0xd08");
        assert_eq!(processor("processor\t: 0\n"), None);
    }
}
