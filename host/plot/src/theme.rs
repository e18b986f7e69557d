//! Colours and sizes in one place.
//!
//! Two demands fix the colours of curves: text in them reads on white (contrast at least 4.5), and any two stay apart by
//! a CIELAB distance of at least 29 in normal sight and with either red-green deficiency (20 with the rare blue-yellow
//! one), as simulated after Machado, Oliveira and Fernandes (2009). That leaves few colours; further curves are
//! distinguished by dashes. The figure brings its own white ground and reads the same in a light and in a dark viewer.

use super::figure::Role;

pub(super) const GROUND: &str = "#ffffff";
pub(super) const FRAME: &str = "#d5dae0";
pub(super) const GRID: &str = "#e8ebef";
pub(super) const AXIS: &str = "#8a94a0";
pub(super) const BAND: &str = "#d4eddc";
pub(super) const BAND_EDGE: &str = "#8cc9a1";
pub(super) const INK: &str = "#1c2430";
pub(super) const SOFT_INK: &str = "#55606d";

pub(super) const FONT: &str = "Helvetica, Arial, sans-serif";
pub(super) const TITLE_PX: f64 = 21.0;
pub(super) const PANEL_TITLE_PX: f64 = 15.0;
pub(super) const LABEL_PX: f64 = 14.0;
pub(super) const TICK_PX: f64 = 14.0;
pub(super) const CAPTION_PX: f64 = 14.0;

/// How a curve is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub(super) colour: &'static str,
    pub(super) width_px: f64,
    /// Value of `stroke-dasharray`; `None` for a solid line.
    pub(super) dash: Option<&'static str>,
}

/// The pen of a role.
pub(super) fn pen(role: Role) -> Pen {
    const PEERS: [&str; 3] = ["#a100f2", "#8c0012", "#a55b65"];
    const BEFORE: &str = "#c65200";
    const AFTER: &str = "#0067a8";
    // The most distinct ones first.
    const LINES: [&str; Role::COLOURS] = [AFTER, BEFORE, PEERS[0], PEERS[1], PEERS[2]];
    const DASHES: [Option<&str>; 4] = [None, Some("9 4"), Some("3 3"), Some("10 3 2 3")];
    match role {
        Role::Before => Pen { colour: BEFORE, width_px: 1.7, dash: None },
        Role::After => Pen { colour: AFTER, width_px: 2.0, dash: None },
        Role::Line { colour, dash } => {
            Pen { colour: LINES[colour % LINES.len()], width_px: 1.8, dash: DASHES[dash % DASHES.len()] }
        }
        Role::Reference => Pen { colour: "#55606d", width_px: 1.5, dash: Some("6 4") },
        Role::Limit => Pen { colour: "#55606d", width_px: 1.5, dash: Some("1.5 3.5") },
        Role::Other(index) => {
            let dash = (index / PEERS.len() % 2 == 1).then_some("9 4");
            Pen { colour: PEERS[index % PEERS.len()], width_px: 1.8, dash }
        }
    }
}
