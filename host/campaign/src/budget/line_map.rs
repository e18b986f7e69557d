//! A map of what delay, jitter and loss of the line a law tolerates, from a campaign over these axes.

use std::collections::BTreeSet;
use std::path::Path;

use crate::cell::Cell;
use crate::facts::{CAMPAIGN, Facts};
use crate::limit::Limits;
use crate::map::{Grid, Measure, PlaceError, Placed, Side};
use crate::merge::RESULTS;
use crate::row::Columns;
use crate::settings::Limit;
use crate::table::Table;
use crate::{Campaign, CampaignError};
use lashloop_bench::scenario::Scenario;
use lashloop_plant::Plants;
use serde_json::{Map, Value};

use super::point::Point;
use super::shipped_map;

/// The axes of a map, as a campaign names them.
pub const AXES: [&str; 3] = ["line.delay_us", "line.jitter_us", "line.loss"];

/// Why a campaign or a scenario has no map.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    #[error(
        "{map}: no part is a grid over exactly {}; run campaigns/link-budget.toml or a campaign with these axes",
        AXES.join(", ")
    )]
    NoAxes { map: String },
    #[error("{map}: no metric is ranked; add `of` to [evidence] of its campaign, such as settle_time_s")]
    NoMetric { map: String },
    #[error("{map}: {metric} of variant {variant} has no limit; add an expectation with `max`")]
    NoLimit { map: String, metric: String, variant: String },
    #[error("{map} has no law {law}, only {laws}; run a campaign with this law and give its folder by --map")]
    NoLaw { map: String, law: String, laws: String },
    #[error(
        "{map} is of {what} {of_map}, the scenario has {of_scenario}; run a campaign of this scenario and give its \
         folder by --map"
    )]
    OtherLoop { map: String, what: &'static str, of_map: String, of_scenario: String },
    #[error("the line is beyond the map: {0}")]
    Beyond(#[from] PlaceError),
    #[error(transparent)]
    Campaign(#[from] CampaignError),
}

/// A metric over delay, jitter and loss, for each variant of a campaign.
#[derive(Debug)]
pub struct LineMap {
    /// Where it comes from.
    pub name: String,
    pub metric: String,
    pub variants: Vec<VariantMap>,
}

/// The map of one variant.
#[derive(Debug)]
pub struct VariantMap {
    pub name: String,
    pub limit: Limit,
    /// The scenario of its first case.
    pub scenario: Scenario,
    pub grid: Grid,
    /// Place of [`AXES`] among those of the grid.
    pub axes: [usize; 3],
}

/// How far a quantity may go until the limit is missed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Border {
    At(f64),
    /// Not before the edge of the map.
    Edge(f64),
}

impl LineMap {
    /// The map that the program has, of `campaigns/link-budget.toml`.
    ///
    /// # Errors
    /// None, unless the files of the program contradict each other.
    pub fn shipped() -> Result<Self, MapError> {
        let campaign = shipped_map::campaign()?;
        let (mut map, part, _) = Self::empty(shipped_map::CAMPAIGN, &campaign)?;
        for (case, cell) in shipped_map::cells() {
            map.push(&campaign, part, case, cell);
        }
        Ok(map)
    }

    /// The map of a merged campaign.
    ///
    /// # Errors
    /// The folder has no merged campaign, or the campaign lacks axes, metric or limit.
    pub fn read(folder: &Path, plants: &Plants) -> Result<Self, MapError> {
        let campaign = Facts::read(&folder.join(CAMPAIGN))?.campaign(plants)?;
        let (mut map, part, measure) = Self::empty(&folder.display().to_string(), &campaign)?;
        Table::new(&campaign, &folder.join(RESULTS)).for_each(|row| {
            let cell = measure.of(&row).ok_or("a field is neither a number nor a reason")?;
            map.push(&campaign, part, row.case, cell);
            Ok(())
        })?;
        Ok(map)
    }

    /// A map without values, the part that it shows, and what it shows of a run.
    fn empty(name: &str, campaign: &Campaign) -> Result<(Self, usize, Measure), MapError> {
        let name = name.to_owned();
        let of_parts = campaign.file.parts.iter().enumerate().find_map(|(part, settings)| {
            let place = |key: &str| settings.axes.iter().position(|axis| axis.keys == [key]);
            let [delay, jitter, loss] = AXES.map(place);
            let grid = Grid::of(settings, usize::MAX).filter(|grid| grid.axes.len() == AXES.len())?;
            Some((part, [delay?, jitter?, loss?], grid))
        });
        let Some((part, axes, grid)) = of_parts else { return Err(MapError::NoAxes { map: name }) };
        let Some(metric) = campaign.file.evidence.of.clone() else {
            return Err(MapError::NoMetric { map: name });
        };
        let Some(measure) = Measure::column(&Columns::of(campaign), &metric) else {
            return Err(MapError::NoMetric { map: name });
        };
        let variants = campaign.variants.iter().enumerate().map(|(variant, it)| {
            let scenario = campaign.scenario(&campaign.first_case(part, variant))?;
            let limits = Limits::new(campaign, part, variant)?;
            let limit = limits.of_measure(measure).ok_or_else(|| MapError::NoLimit {
                map: name.clone(),
                metric: metric.clone(),
                variant: it.name.clone(),
            })?;
            Ok(VariantMap { name: it.name.clone(), limit, scenario, grid: grid.clone(), axes })
        });
        let variants = variants.collect::<Result<_, MapError>>()?;
        Ok((Self { name, metric, variants }, part, measure))
    }

    fn push(&mut self, campaign: &Campaign, part: usize, case: u64, cell: Cell) {
        let (of_part, row, variant) = campaign.plan.place(case);
        if of_part == part {
            self.variants[variant].grid.push(row, cell);
        }
    }

    /// The map of the law of a scenario.
    ///
    /// # Errors
    /// The map has no such law, or is of another plant model or control period.
    pub fn of_law(&self, scenario: &Scenario) -> Result<&VariantMap, MapError> {
        let law = &scenario.controller.name;
        let of_law = self.variants.iter().find(|it| it.scenario.controller.name == *law);
        let variant = of_law.ok_or_else(|| {
            let laws: Vec<_> = self.variants.iter().map(|it| it.scenario.controller.name.as_str()).collect();
            MapError::NoLaw { map: self.name.clone(), law: law.clone(), laws: laws.join(", ") }
        })?;
        let facts = |scenario: &Scenario| {
            let period = format!("{} us", scenario.run.control_period_us);
            [("plant", scenario.plant.model.name().to_owned()), ("control period", period)]
        };
        for ((what, of_map), (_, of_scenario)) in facts(&variant.scenario).into_iter().zip(facts(scenario)) {
            if of_map != of_scenario {
                return Err(MapError::OtherLoop { map: self.name.clone(), what, of_map, of_scenario });
            }
        }
        Ok(variant)
    }
}

/// The first key with another value.
fn difference(path: &str, of_map: &Value, here: &Value) -> Option<String> {
    if let (Value::Object(of_map), Value::Object(here)) = (of_map, here) {
        let keys: BTreeSet<_> = of_map.keys().chain(here.keys()).collect();
        let value = |object: &Map<String, Value>, key| object.get(key).cloned().unwrap_or_default();
        return keys
            .into_iter()
            .find_map(|key| difference(&format!("{path}.{key}"), &value(of_map, key), &value(here, key)));
    }
    (of_map != here).then(|| format!("{path} is {here}, {of_map} on the map"))
}

impl VariantMap {
    /// The first key of plant, encoders and parameters of the law that differs from the map's scenario.
    #[must_use]
    pub fn difference(&self, scenario: &Scenario) -> Option<String> {
        let [of_map, here] =
            [&self.scenario, scenario].map(|it| serde_json::to_value(it).unwrap_or_default());
        let sections = ["plant", "encoders", "controller"];
        sections.into_iter().find_map(|it| difference(it, &of_map[it], &here[it]))
    }

    /// # Errors
    /// The point is beyond the map.
    pub fn place(&self, point: Point) -> Result<Placed, PlaceError> {
        self.grid.place(&self.in_order(point), self.limit)
    }

    /// How far delay, jitter and loss may each rise from a point inside.
    ///
    /// # Errors
    /// The point is beyond the map.
    pub fn borders(&self, point: Point) -> Result<[Border; 3], PlaceError> {
        let mut borders = [Border::Edge(0.0); 3];
        for (axis, border) in borders.iter_mut().enumerate() {
            *border = self.rise(point, axis)?;
        }
        Ok(borders)
    }

    /// The longest delay up to that of a point outside that is inside, with the same jitter and loss; `None` if none is.
    ///
    /// # Errors
    /// The point is beyond the map.
    pub fn longest_delay_us(&self, point: Point) -> Result<Option<f64>, PlaceError> {
        let mut outside = point.delay_us;
        for tick in self.ticks(0).into_iter().rev().filter(|tick| *tick < point.delay_us) {
            if self.is_inside(point, 0, tick)? {
                return self.bisect(point, 0, tick, outside).map(Some);
            }
            outside = tick;
        }
        Ok(None)
    }

    fn rise(&self, point: Point, axis: usize) -> Result<Border, PlaceError> {
        let mut inside = point.values()[axis];
        for tick in self.ticks(axis) {
            if tick > inside {
                if !self.is_inside(point, axis, tick)? {
                    return self.bisect(point, axis, inside, tick).map(Border::At);
                }
                inside = tick;
            }
        }
        Ok(Border::Edge(inside))
    }

    /// The last value inside, to a thousandth of the interval.
    fn bisect(&self, point: Point, axis: usize, inside: f64, outside: f64) -> Result<f64, PlaceError> {
        let (mut inside, mut outside) = (inside, outside);
        for _ in 0..10 {
            let middle = f64::midpoint(inside, outside);
            *if self.is_inside(point, axis, middle)? { &mut inside } else { &mut outside } = middle;
        }
        Ok(inside)
    }

    fn is_inside(&self, point: Point, axis: usize, value: f64) -> Result<bool, PlaceError> {
        let mut values = point.values();
        values[axis] = value;
        let [delay_us, jitter_us, loss] = values;
        Ok(self.place(Point { delay_us, jitter_us, loss })?.side == Side::Inside)
    }

    /// Values of an axis of [`AXES`], ascending. A grid of all cells has one value for each tick.
    pub fn ticks(&self, axis: usize) -> Vec<f64> {
        let ticks = &self.grid.axes[self.axes[axis]].ticks;
        let mut ticks: Vec<_> = ticks.iter().filter_map(|[first, _]| first.number()).collect();
        ticks.sort_by(f64::total_cmp);
        ticks
    }

    fn in_order(&self, point: Point) -> [f64; 3] {
        let mut ordered = [0.0; 3];
        for (value, axis) in point.values().into_iter().zip(self.axes) {
            ordered[axis] = value;
        }
        ordered
    }
}
