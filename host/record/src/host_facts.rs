//! The computer that ran the bench, as far as it can change timing or bits.

use std::fs;

use serde::{Deserialize, Serialize};

/// Facts of the host. `None` is what the system does not report.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HostFacts {
    /// Release of the kernel.
    pub kernel: String,
    /// Model of the first processor.
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
        let model =
            cpus.lines().filter_map(|it| it.split_once(':')).find(|(key, _)| key.trim() == "model name");
        Self {
            kernel: rustix::system::uname().release().to_string_lossy().into_owned(),
            cpu: model.map(|(_, name)| name.trim().to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            governor: line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
            clock_source: line("/sys/devices/system/clocksource/clocksource0/current_clocksource"),
        }
    }
}
