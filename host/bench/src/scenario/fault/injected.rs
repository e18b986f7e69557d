//! One entry of `[[fault]]`: the kind of fault, when it begins and how long it lasts.

use serde::Serialize;

use super::device::DeviceFault;
use super::encoder::{EncoderFault, Side};
use super::kinds::FaultDuration;
use super::link::{FrameFault, LinkFault, Way};
use super::motor::MotorFault;
use super::plant::PlantFault;
use crate::scenario::RunMode;
use crate::scenario::bench::obstacle_to_fault;
use crate::scenario::range::positive;
use crate::scenario::reader::Section;
use crate::scenario::sections::RunSettings;
use crate::scenario::spelling::either;
use lashloop_plant::{PlantModel, Plants};

/// A fault to inject during the run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InjectedFault {
    /// Time of the run at which it begins, 0 to 1e5 s and before the end of the run.
    pub at_s: f64,
    /// How long it lasts, > 0 and <= 1e5 s; `None` for the rest of the run. See [`FaultDuration`] for the clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
    /// What goes wrong.
    #[serde(flatten)]
    pub kind: FaultKind,
}

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
    pub const fn name(&self) -> &'static str {
        self.entry().0
    }

    /// What ends a fault of this kind.
    #[must_use]
    pub const fn duration(&self) -> FaultDuration {
        self.entry().1
    }

    /// Whether faults of this kind hit frames or the connection.
    pub(crate) const fn strikes_link(&self) -> bool {
        match self {
            Self::Frame { .. } | Self::Link(_) => true,
            Self::Encoder { .. } | Self::Motor(_) | Self::Plant(_) | Self::Device(_) => false,
        }
    }

    /// The kind's entry in the table of its group.
    const fn entry(&self) -> (&'static str, FaultDuration) {
        match self {
            Self::Frame { fault, .. } => fault.entry(),
            Self::Link(fault) => fault.entry(),
            Self::Encoder { fault, .. } => fault.entry(),
            Self::Motor(fault) => fault.entry(),
            Self::Plant(fault) => fault.entry(),
            Self::Device(fault) => fault.entry(),
        }
    }

    fn read(fault: &mut Section<'_>) -> Option<Self> {
        let groups = [
            FrameFault::KINDS,
            LinkFault::KINDS,
            EncoderFault::KINDS,
            MotorFault::KINDS,
            PlantFault::KINDS,
            DeviceFault::KINDS,
        ];
        let kinds = groups.concat();
        let choices: Vec<_> = kinds.iter().map(|kind| (kind.name, kind.name)).collect();
        let name = fault.doc("What goes wrong.").choice_docs(kinds).choice("kind", None, &choices)?;
        FrameFault::read(name, fault)
            .map(|kind| Self::Frame { fault: kind, way: Way::read(fault) })
            .or_else(|| LinkFault::read(name, fault).map(Self::Link))
            .or_else(|| {
                EncoderFault::read(name, fault)
                    .map(|kind| Self::Encoder { fault: kind, side: Side::read(fault) })
            })
            .or_else(|| MotorFault::read(name, fault).map(Self::Motor))
            .or_else(|| PlantFault::read(name, fault).map(Self::Plant))
            .or_else(|| DeviceFault::read(name, fault).map(Self::Device))
    }
}

/// Takes the place of a faulty entry until the scenario is rejected.
const STAND_IN: FaultKind = FaultKind::Link(LinkFault::Cut {});

/// Reads one fault of a scenario with this plant and this run.
pub(in crate::scenario) fn read(
    fault: &mut Section<'_>,
    model: &PlantModel,
    plants: &Plants,
    run: &RunSettings,
) -> InjectedFault {
    let at_s = fault.doc("Time of the run at which the fault begins, before the end of the run.").number(
        "at_s",
        None,
        0.0..=1e5,
    );
    let for_s = fault
        .doc("How long it lasts; absent for the rest of the run. `link-cut` and `device-hang` last in wall-clock time and need it; `device-reset` takes none.")
        .optional_number("for_s", "s", positive(1e5));
    if run.step_at(at_s) >= run.steps() {
        let last_s = f64::from(run.steps().saturating_sub(1)) * f64::from(run.control_period_us) / 1e6;
        fault.reject(
            "at_s",
            format!("is not before the end of the run, whose last step begins at {last_s} s"),
        );
    }
    let Some(kind) = FaultKind::read(fault) else {
        fault.accept_the_rest();
        return InjectedFault { at_s, for_s, kind: STAND_IN };
    };
    if let FaultKind::Plant(change) = &kind
        && !change.is_taken_by(model)
    {
        let takers = either(plants.iter().filter(|it| change.is_taken_by(it)).map(|it| it.name()));
        fault.reject("kind", format!("needs plant.model = {takers}: {} takes no such change", model.name()));
    }
    if let (RunMode::Bench, Some(reason)) = (run.mode, obstacle_to_fault(kind)) {
        fault.reject("kind", reason.to_owned());
    }
    match (kind.duration(), for_s) {
        (FaultDuration::Momentary, Some(_)) => {
            fault.reject("for_s", "gives a duration, but a reset is over at once; omit it".to_owned());
        }
        (FaultDuration::WallClock, None) => {
            fault.reject("kind", "needs for_s: how long it lasts".to_owned());
        }
        (FaultDuration::Simulated, _)
        | (FaultDuration::Momentary, None)
        | (FaultDuration::WallClock, Some(_)) => {}
    }
    InjectedFault { at_s, for_s, kind }
}
