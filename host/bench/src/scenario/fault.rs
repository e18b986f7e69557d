//! `[[fault]]`: what goes wrong during the run, when, for how long and how badly.

use lashloop_protocol::EncoderCounts;
use serde::Serialize;

use super::plant::PlantModel;
use super::range::{positive, within};
use super::reader::Section;
use super::sections::RunSettings;
use super::unit;

/// One fault of the timeline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// Time of the run at which it begins.
    pub at_s: f64,
    /// How long it lasts; `None` for the rest of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
    /// What it is, by its name.
    #[serde(rename = "kind")]
    pub name: &'static str,
    /// What it is, with all that belongs to it.
    #[serde(flatten)]
    pub kind: FaultKind,
}

/// Which end of the gears an encoder sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The motor's.
    Motor,
    /// The load's.
    Load,
}

/// Which way on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// From the bench to the drive.
    ToDrive,
    /// From the drive to the bench.
    ToBench,
    /// Both.
    Both,
}

impl Way {
    /// Whether frames to the drive are meant.
    #[must_use]
    pub fn is_to_drive(self) -> bool {
        matches!(self, Self::ToDrive | Self::Both)
    }

    /// Whether frames to the bench are meant.
    #[must_use]
    pub fn is_to_bench(self) -> bool {
        matches!(self, Self::ToBench | Self::Both)
    }
}

/// What can go wrong. `share` is the share of frames that are hit, drawn from the seed of the run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum FaultKind {
    /// A byte of a frame is lost.
    LinkByteLoss {
        /// Which way.
        way: Way,
        /// Of frames.
        share: f64,
    },
    /// A bit of a frame is flipped.
    LinkBitFlip {
        /// Which way.
        way: Way,
        /// Of frames.
        share: f64,
    },
    /// A run of bytes of a frame is replaced by others.
    LinkBurst {
        /// Which way.
        way: Way,
        /// Of frames.
        share: f64,
        /// How many.
        bytes: u32,
    },
    /// A frame comes twice.
    LinkDuplicate {
        /// Which way.
        way: Way,
        /// Of frames.
        share: f64,
    },
    /// A frame comes after the one that followed it.
    LinkReorder {
        /// Which way.
        way: Way,
        /// Of frames.
        share: f64,
    },
    /// Every frame takes longer, in order.
    LinkDelay {
        /// Which way.
        way: Way,
        /// By how much.
        delay_ms: f64,
        /// And by up to so much more.
        jitter_ms: f64,
    },
    /// Nothing passes; all of it comes when the fault is over.
    LinkStall {
        /// Which way.
        way: Way,
    },
    /// The line is cut, and comes back when the fault is over.
    LinkCut {},
    /// An encoder keeps its count.
    EncoderStuck {
        /// Whose.
        side: Side,
    },
    /// An encoder reads zero.
    EncoderDead {
        /// Whose.
        side: Side,
    },
    /// An encoder counts on from another count, at once.
    EncoderJump {
        /// Whose.
        side: Side,
        /// By how many.
        counts: i32,
    },
    /// An encoder drifts away, evenly in `over_s`, and stays there.
    EncoderOffset {
        /// Whose.
        side: Side,
        /// How far.
        counts: i32,
        /// In which time.
        over_s: f64,
    },
    /// An encoder misses counts of either direction.
    EncoderLostCounts {
        /// Whose.
        side: Side,
        /// Of counts.
        share: f64,
    },
    /// An encoder's counts scatter evenly.
    EncoderNoise {
        /// Whose.
        side: Side,
        /// By up to so many, either way.
        counts: u32,
    },
    /// An encoder counts the wrong way.
    EncoderReversed {
        /// Whose.
        side: Side,
    },
    /// The motor gives no more than so much.
    TorqueSaturation {
        /// How much.
        limit_nm: f64,
    },
    /// The motor gives so many times what it is told.
    TorqueGain {
        /// How many.
        gain: f64,
    },
    /// The motor gives what it was told some steps before.
    TorqueDelay {
        /// How many.
        steps: u32,
    },
    /// The motor gives nothing.
    TorqueDead {},
    /// The gap is wider, its half by so much.
    GapGrowth {
        /// How much.
        growth_rad: f64,
    },
    /// The stiffness is so many times what it was.
    StiffnessDrop {
        /// How many.
        factor: f64,
    },
    /// A torque on the load, towards positive angles.
    LoadTorque {
        /// How much.
        torque_nm: f64,
    },
    /// Dry friction of the load is so many times what it was.
    FrictionChange {
        /// How many.
        factor: f64,
    },
    /// The drive starts anew, as after a moment without power.
    DeviceReset {},
    /// The drive stops working, and goes on when the fault is over.
    DeviceHang {},
}

/// Where a fault is applied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// On the line.
    Link,
    /// In an encoder.
    Sensor,
    /// In the motor.
    Actuator,
    /// In the gears and at the load.
    Plant,
    /// In the drive.
    Device,
}

impl FaultKind {
    /// Where it is applied.
    #[must_use]
    pub fn place(&self) -> Place {
        use FaultKind as Kind;
        match self {
            Kind::LinkByteLoss { .. }
            | Kind::LinkBitFlip { .. }
            | Kind::LinkBurst { .. }
            | Kind::LinkDuplicate { .. }
            | Kind::LinkReorder { .. }
            | Kind::LinkDelay { .. }
            | Kind::LinkStall { .. }
            | Kind::LinkCut {} => Place::Link,
            Kind::EncoderStuck { .. }
            | Kind::EncoderDead { .. }
            | Kind::EncoderJump { .. }
            | Kind::EncoderOffset { .. }
            | Kind::EncoderLostCounts { .. }
            | Kind::EncoderNoise { .. }
            | Kind::EncoderReversed { .. } => Place::Sensor,
            Kind::TorqueSaturation { .. }
            | Kind::TorqueGain { .. }
            | Kind::TorqueDelay { .. }
            | Kind::TorqueDead {} => Place::Actuator,
            Kind::GapGrowth { .. }
            | Kind::StiffnessDrop { .. }
            | Kind::LoadTorque { .. }
            | Kind::FrictionChange { .. } => Place::Plant,
            Kind::DeviceReset {} | Kind::DeviceHang {} => Place::Device,
        }
    }
}

type Read = fn(&mut Section<'_>) -> FaultKind;

const KINDS: [(&str, Read); 25] = [
    ("link-byte-loss", |s| FaultKind::LinkByteLoss { way: way(s), share: share(s) }),
    ("link-bit-flip", |s| FaultKind::LinkBitFlip { way: way(s), share: share(s) }),
    ("link-burst", |s| FaultKind::LinkBurst {
        way: way(s),
        share: share(s),
        bytes: s.integer("bytes", unit::NONE, 8, 1..=64),
    }),
    ("link-duplicate", |s| FaultKind::LinkDuplicate { way: way(s), share: share(s) }),
    ("link-reorder", |s| FaultKind::LinkReorder { way: way(s), share: share(s) }),
    ("link-delay", |s| FaultKind::LinkDelay {
        way: way(s),
        delay_ms: s.number("delay_ms", unit::MILLISECOND, None, within(0.0, 1e4)),
        jitter_ms: s.number("jitter_ms", unit::MILLISECOND, 0.0, within(0.0, 1e4)),
    }),
    ("link-stall", |s| FaultKind::LinkStall { way: way(s) }),
    ("link-cut", |_| FaultKind::LinkCut {}),
    ("encoder-stuck", |s| FaultKind::EncoderStuck { side: side(s) }),
    ("encoder-dead", |s| FaultKind::EncoderDead { side: side(s) }),
    ("encoder-jump", |s| FaultKind::EncoderJump { side: side(s), counts: counts(s) }),
    ("encoder-offset", |s| FaultKind::EncoderOffset {
        side: side(s),
        counts: counts(s),
        over_s: s.number("over_s", unit::SECOND, None, positive(1e5)),
    }),
    ("encoder-lost-counts", |s| FaultKind::EncoderLostCounts { side: side(s), share: share(s) }),
    ("encoder-noise", |s| FaultKind::EncoderNoise {
        side: side(s),
        counts: s.integer("counts", unit::COUNT, None, 1..=1_000_000),
    }),
    ("encoder-reversed", |s| FaultKind::EncoderReversed { side: side(s) }),
    ("torque-saturation", |s| FaultKind::TorqueSaturation {
        limit_nm: s.number("limit_nm", unit::NEWTON_METRE, None, within(0.0, 1e6)),
    }),
    ("torque-gain", |s| FaultKind::TorqueGain {
        gain: s.number("gain", unit::NONE, None, within(-1e3, 1e3)),
    }),
    ("torque-delay", |s| FaultKind::TorqueDelay { steps: s.integer("steps", unit::STEP, None, 1..=1_000) }),
    ("torque-dead", |_| FaultKind::TorqueDead {}),
    ("gap-growth", |s| FaultKind::GapGrowth {
        growth_rad: s.number("growth_rad", unit::RADIAN, None, positive(3.0)),
    }),
    ("stiffness-drop", |s| FaultKind::StiffnessDrop { factor: factor(s) }),
    ("load-torque", |s| FaultKind::LoadTorque {
        torque_nm: s.number("torque_nm", unit::NEWTON_METRE, None, within(-1e6, 1e6)),
    }),
    ("friction-change", |s| FaultKind::FrictionChange { factor: factor(s) }),
    ("device-reset", |_| FaultKind::DeviceReset {}),
    ("device-hang", |_| FaultKind::DeviceHang {}),
];

fn way(fault: &mut Section<'_>) -> Way {
    let words = [("both", Way::Both), ("to-drive", Way::ToDrive), ("to-bench", Way::ToBench)];
    fault.choice("way", Way::Both, &words).unwrap_or(Way::Both)
}

fn share(fault: &mut Section<'_>) -> f64 {
    fault.number("share", unit::NONE, None, positive(1.0))
}

fn side(fault: &mut Section<'_>) -> Side {
    fault.choice("side", None, &[("motor", Side::Motor), ("load", Side::Load)]).unwrap_or(Side::Motor)
}

fn counts(fault: &mut Section<'_>) -> i32 {
    // A whole turn of the reading's range would not show.
    let most = EncoderCounts::MAX.get();
    fault.integer("counts", unit::COUNT, None, -most..=most)
}

fn factor(fault: &mut Section<'_>) -> f64 {
    fault.number("factor", unit::NONE, None, positive(100.0))
}

/// Reads one fault of a scenario with this plant and this run.
pub(super) fn read(fault: &mut Section<'_>, model: PlantModel, run: &RunSettings) -> Fault {
    let kinds: Vec<_> = KINDS.iter().map(|(name, read)| (*name, (*name, *read))).collect();
    let at_s = fault.number("at_s", unit::SECOND, None, within(0.0, 1e5));
    let for_s = fault.optional_number("for_s", unit::SECOND, positive(1e5));
    if run.step_at(at_s) >= run.steps() {
        let last_s = f64::from(run.steps().saturating_sub(1)) * f64::from(run.control_period_us) / 1e6;
        fault.reject(
            "at_s",
            format!("is not before the end of the run, whose last step begins at {last_s} s"),
        );
    }
    let Some((name, read)) = fault.choice("kind", None, &kinds) else {
        fault.accept_the_rest();
        return Fault { at_s, for_s, name: "", kind: FaultKind::LinkCut {} };
    };
    let kind = read(fault);
    if kind.place() == Place::Plant && model != PlantModel::BacklashShaft {
        fault.reject(
            "kind",
            "needs plant.model = \"backlash-shaft\": no other plant changes while it runs".to_owned(),
        );
    }
    if kind == (FaultKind::DeviceReset {}) && for_s.is_some() {
        fault.reject("for_s", "says how long, but a reset is over at once; leave it away".to_owned());
    }
    if matches!(kind, FaultKind::LinkCut {} | FaultKind::DeviceHang {}) && for_s.is_none() {
        fault.reject("kind", "needs for_s: how long it lasts".to_owned());
    }
    Fault { at_s, for_s, name, kind }
}
