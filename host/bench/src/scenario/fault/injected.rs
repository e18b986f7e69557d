//! One entry of `[[fault]]`: the kind of fault, when it begins and how long it lasts.

use serde::Serialize;

use super::device::DeviceFault;
use super::encoder::{EncoderFault, Side};
use super::link::{FrameFault, LinkFault, Way};
use super::motor::MotorFault;
use super::plant::PlantFault;
use crate::scenario::RunMode;
use crate::scenario::declare::{Field as _, Variants, choice, number, tagged};
use crate::scenario::key::Choice;
use crate::scenario::range::positive;
use crate::scenario::reader::Section;
use crate::scenario::sections::RunSettings;
use crate::scenario::spelling::either;
use crate::settings;
use lashloop_plant::{PlantModel, Plants};

/// What ends a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultDuration {
    /// `for_s` in time of the run; without `for_s` the end of the run.
    Simulated,
    /// The step in which it begins.
    Momentary,
    /// `for_s` in the link's time, since there may be no steps meanwhile.
    WallClock,
}

settings! {
    /// A fault to inject during the run.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct InjectedFault {
        /// Time of the run at which the fault begins, before the end of the run.
        pub at_s: f64 = number(0.0..=1e5),
        /// How long it lasts; absent for the rest of the run. `link-cut` and `device-hang` last in wall-clock time and need it;
        /// `device-reset` takes none.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub for_s: Option<f64> = number(positive(1e5)).optional(),
        /// What goes wrong.
        #[serde(flatten)]
        pub kind: FaultKind = tagged(false).map(|kind, _| kind.unwrap_or(STAND_IN)),
    }
}

/// Takes the place of a faulty entry until the scenario is rejected: a kind that is possible in every run.
const STAND_IN: FaultKind = FaultKind::Frame { fault: FrameFault::Stall {}, way: Way::Both };

/// Kinds of fault by what they strike.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum FaultKind {
    /// Frames on the link.
    Frame {
        /// What happens to them.
        #[serde(flatten)]
        fault: FrameFault,
        /// Their direction.
        way: Way,
    },
    /// The connection.
    Link(LinkFault),
    /// An encoder.
    Encoder {
        /// What happens to its counts.
        #[serde(flatten)]
        fault: EncoderFault,
        /// Which encoder.
        side: Side,
    },
    /// The motor.
    Motor(MotorFault),
    /// Gap, shaft and load.
    Plant(PlantFault),
    /// The drive.
    Device(DeviceFault),
}

impl FaultKind {
    /// The kind's name, as scenarios and records spell it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        Variants::name(self)
    }

    /// What ends a fault of this kind.
    #[must_use]
    pub const fn duration(&self) -> FaultDuration {
        match self {
            Self::Device(DeviceFault::Reset {}) => FaultDuration::Momentary,
            Self::Link(LinkFault::Cut {}) | Self::Device(DeviceFault::Hang {}) => FaultDuration::WallClock,
            Self::Frame { .. } | Self::Encoder { .. } | Self::Motor(_) | Self::Plant(_) => {
                FaultDuration::Simulated
            }
        }
    }

    /// Whether faults of this kind hit frames or the connection.
    pub(crate) const fn strikes_link(&self) -> bool {
        match self {
            Self::Frame { .. } | Self::Link(_) => true,
            Self::Encoder { .. } | Self::Motor(_) | Self::Plant(_) | Self::Device(_) => false,
        }
    }

    /// Why faults of this kind can't strike in bench mode; `None` if they can.
    const fn obstacle_in_bench_mode(&self) -> Option<&'static str> {
        match self {
            Self::Frame { fault: FrameFault::Stall {}, .. }
            | Self::Link(LinkFault::Cut {})
            | Self::Device(_) => None,
            Self::Frame { .. } => Some(
                "strikes frames with samples and torques, which bench mode doesn't send; take link-stall or link-cut, or \
                 run.mode = \"hil\"",
            ),
            Self::Encoder { .. } | Self::Motor(_) | Self::Plant(_) => Some(
                "strikes the simulated side of the loop, which bench mode doesn't have; take run.mode = \"hil\"",
            ),
        }
    }
}

impl Variants for FaultKind {
    fn choices() -> Vec<Choice> {
        let groups = [
            FrameFault::choices(),
            LinkFault::choices(),
            EncoderFault::choices(),
            MotorFault::choices(),
            PlantFault::choices(),
            DeviceFault::choices(),
        ];
        groups.concat()
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Frame { fault, .. } => fault.name(),
            Self::Link(fault) => fault.name(),
            Self::Encoder { fault, .. } => fault.name(),
            Self::Motor(fault) => fault.name(),
            Self::Plant(fault) => fault.name(),
            Self::Device(fault) => fault.name(),
        }
    }

    fn read(name: &str, fault: &mut Section<'_>) -> Option<Self> {
        if let Some(kind) = FrameFault::read(name, fault) {
            let way = choice().or(Way::Both).read("way", "Direction of the frames.", fault);
            return Some(Self::Frame { fault: kind, way });
        }
        if let Some(kind) = EncoderFault::read(name, fault) {
            let side = choice().read("side", "The encoder's side of the gears.", fault);
            return Some(Self::Encoder { fault: kind, side });
        }
        (LinkFault::read(name, fault).map(Self::Link))
            .or_else(|| MotorFault::read(name, fault).map(Self::Motor))
            .or_else(|| PlantFault::read(name, fault).map(Self::Plant))
            .or_else(|| DeviceFault::read(name, fault).map(Self::Device))
    }
}

impl InjectedFault {
    /// The fault, with what is wrong with its keys together.
    pub(in crate::scenario) fn checked(self, fault: &mut Section<'_>) -> Self {
        match (self.kind.duration(), self.for_s) {
            (FaultDuration::Momentary, Some(_)) => {
                fault.reject("for_s", "gives a duration, but a reset is over at once; omit it");
            }
            (FaultDuration::WallClock, None) => fault.reject("kind", "needs for_s: how long it lasts"),
            _ => {}
        }
        self
    }

    /// Reports what this run and this plant rule out.
    pub(in crate::scenario) fn check_run(
        &self,
        fault: &Section<'_>,
        model: &PlantModel,
        plants: &Plants,
        run: &RunSettings,
    ) {
        // A faulty duration or time has its own error.
        let is_known = !run.duration_s.is_nan() && !self.at_s.is_nan();
        if is_known && run.step_at(self.at_s) >= run.steps() {
            let last_s = f64::from(run.steps().saturating_sub(1)) * f64::from(run.control_period_us) / 1e6;
            let reason = format!("is not before the end of the run, whose last step begins at {last_s} s");
            fault.reject("at_s", reason);
        }
        if let FaultKind::Plant(change) = &self.kind
            && !change.is_taken_by(model)
        {
            let takers = either(plants.iter().filter(|it| change.is_taken_by(it)).map(|it| it.name()));
            let name = model.name();
            fault.reject("kind", format!("needs plant.model = {takers}: {name} takes no such change"));
        }
        if let (RunMode::Bench, Some(reason)) = (run.mode, self.kind.obstacle_in_bench_mode()) {
            fault.reject("kind", reason);
        }
    }
}
