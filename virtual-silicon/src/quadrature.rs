//! The two channels of an incremental encoder.

/// A channel of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Leads by a quarter of a line when the count rises.
    A,
    /// Lags by a quarter of a line when the count rises.
    B,
}

/// A change of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// The channel.
    pub channel: Channel,
    /// Its level after the edge.
    pub is_high: bool,
}

/// An encoder at a count of quarter lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Quadrature {
    count: i64,
}

impl Quadrature {
    /// An encoder at `count`.
    #[must_use]
    pub fn at(count: i64) -> Self {
        Self { count }
    }

    /// The present count.
    #[must_use]
    pub fn count(&self) -> i64 {
        self.count
    }

    /// The level of a channel.
    #[must_use]
    pub fn is_high(&self, channel: Channel) -> bool {
        let quarter = self.count.rem_euclid(4);
        match channel {
            Channel::A => quarter == 1 || quarter == 2,
            Channel::B => quarter >= 2,
        }
    }

    /// Moves one count towards `target`, and returns the edge of it; `None` at the target.
    pub fn step_towards(&mut self, target: i64) -> Option<Edge> {
        let next = Self { count: self.count + (target - self.count).signum() };
        let channel = [Channel::A, Channel::B].into_iter().find(|&c| next.is_high(c) != self.is_high(c))?;
        *self = next;
        Some(Edge { channel, is_high: self.is_high(channel) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_count_is_one_edge_and_a_leads_upwards() {
        let mut encoder = Quadrature::at(-2);
        let mut edges = Vec::new();
        while let Some(Edge { channel, is_high }) = encoder.step_towards(3) {
            edges.push((channel, is_high));
        }
        use Channel::{A, B};
        assert_eq!(edges, [(A, false), (B, false), (A, true), (B, true), (A, false)]);
        assert_eq!(encoder.count(), 3);
    }

    #[test]
    fn the_way_back_has_the_same_edges_in_reverse() {
        let mut encoder = Quadrature::at(2);
        assert_eq!(encoder.step_towards(1), Some(Edge { channel: Channel::B, is_high: false }));
        assert_eq!(encoder.step_towards(0), Some(Edge { channel: Channel::A, is_high: false }));
        assert_eq!(encoder.step_towards(0), None);
    }
}
