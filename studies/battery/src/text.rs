//! The tables of `lashloop paper battery`: quantiles on random plants, sweeps, limits.

use std::fmt;

use lashloop_bench::run::End;
use lashloop_campaign::CampaignError;
use lashloop_campaign::cell::{Cell, Missing};
use lashloop_campaign::expectation::{Judged, State};
use lashloop_campaign::file::Part;
use lashloop_campaign::report::{Group, QUANTILES, Report};
use lashloop_campaign::table::Table;

use super::campaign::{Battery, RANDOM_PLANTS};
use super::criterion::{Criterion, EVERY_MOVE, OF_ONE_MOVE};

/// The tables of a merged battery.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    battery: Battery,
    report: Report,
    /// Names of the parts with random plants, and whether their reference moves to and fro.
    random: Vec<(String, bool)>,
    sweeps: Vec<Sweep>,
}

#[derive(Debug, Clone, PartialEq)]
struct Sweep {
    battery: Battery,
    name: String,
    unit: String,
    rows: Vec<SweepRow>,
}

#[derive(Debug, Clone, PartialEq)]
struct SweepRow {
    value: String,
    law: String,
    end: String,
    /// Of the swept criteria, in their order.
    cells: Vec<Cell>,
}

impl Tables {
    /// # Errors
    /// The table can't be read, or is not that of its campaign.
    pub fn new(battery: Battery, report: Report, table: &Table<'_>) -> Result<Self, CampaignError> {
        let campaign = table.campaign;
        let parts = &campaign.file.parts;
        let mut sweeps: Vec<_> = campaign.file.parts.iter().map(|_| Vec::new()).collect();
        let place = |name: &str| table.columns.numbers.iter().position(|number| number == name);
        let swept = battery.criteria().filter(|it| it.is_swept);
        let swept: Vec<_> = swept.filter_map(|it| place(it.column)).collect();
        table.for_each(|row| {
            let case = campaign.plan.case(row.case);
            if !parts[case.part].method.is_sampled() {
                let cells = swept.iter().filter_map(|column| row.cell(*column)).collect();
                sweeps[case.part].push(SweepRow {
                    value: case.values.first().map(ToString::to_string).unwrap_or_default(),
                    law: campaign.variants[case.variant].name.clone(),
                    end: row.end().to_owned(),
                    cells,
                });
            }
            Ok(())
        })?;
        let sweeps = campaign.file.parts.iter().zip(sweeps).filter(|(_, rows)| !rows.is_empty());
        let sweeps = sweeps.filter_map(|(part, rows)| {
            let axis = part.axes.first()?;
            let name = axis.label.clone().unwrap_or_else(|| axis.name().to_owned());
            Some(Sweep { battery, name, unit: axis.unit.clone(), rows })
        });
        let moves = |part: &Part| part.set.iter().any(|setting| setting.starts_with("reference="));
        let random = parts.iter().filter(|part| part.method.is_sampled());
        let random = random.map(|part| (part.name.clone(), moves(part)));
        Ok(Self { battery, report, random: random.collect(), sweeps: sweeps.collect() })
    }
}

/// A line of a table with three columns. Its head has space for the longest name of a law.
fn row(out: &mut fmt::Formatter<'_>, head: &str, [one, two, three]: [impl fmt::Display; 3]) -> fmt::Result {
    writeln!(out, "{head:<42}{one:>12}{two:>12}{three:>12}")
}

impl Tables {
    /// Quantiles over the random plants of a part, and its runs without a settling time.
    fn part(&self, out: &mut fmt::Formatter<'_>, part: &str, moves: bool) -> fmt::Result {
        let Report { seed, groups, .. } = &self.report;
        let laws: Vec<_> = groups.iter().filter(|group| group.part == part).collect();
        let plants = laws.first().map_or(0, |group| group.runs);
        let of = if part == RANDOM_PLANTS { "random plants".to_owned() } else { format!("of {part}") };
        row(out, &format!("{plants} {of}, seed {seed}"), QUANTILES.map(|(name, _)| name))?;
        let settling = if moves { EVERY_MOVE } else { OF_ONE_MOVE[0] };
        let applies = |criterion: &&Criterion| !(moves && OF_ONE_MOVE.contains(&criterion.column));
        for criterion in self.battery.criteria().filter(applies) {
            let mut name = format!("{}, {}", criterion.name, criterion.unit);
            for group in &laws {
                let Some(it) = group.columns.iter().find(|it| it.column == criterion.column) else {
                    continue;
                };
                let cells = [it.median, it.p95, it.max].map(|cell| criterion.cell(cell));
                row(out, &format!("{name:<26}{}", group.variant), cells)?;
                name.clear();
            }
        }
        writeln!(out)?;
        let reasons = [Missing::Never, Missing::CutShort, Missing::NotFinite];
        row(out, "runs without a settle time", reasons)?;
        for Group { variant, runs, columns, .. } in laws {
            let settling = columns.iter().find(|it| it.column == settling);
            let counts = reasons
                .map(|reason| settling.and_then(|it| it.missing.get(reason.word())).copied().unwrap_or(0));
            row(out, &format!("{:<26}{variant}", format!("of {runs}")), counts)?;
        }
        Ok(())
    }
}

impl fmt::Display for Tables {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Report { expectations, verdict, .. } = &self.report;
        for (at, (part, moves)) in self.random.iter().enumerate() {
            if at > 0 {
                writeln!(out)?;
            }
            self.part(out, part, *moves)?;
        }
        for sweep in &self.sweeps {
            writeln!(out, "\n{sweep}")?;
        }
        if expectations.is_empty() {
            return write!(out, "\nno limits: none of these laws has any");
        }
        for mine in
            expectations.chunk_by(|one, next| (&one.variant, &one.part) == (&next.variant, &next.part))
        {
            let law = mine[0].variant.as_deref().unwrap_or("all laws");
            let part = mine[0].part.as_deref().filter(|part| *part != RANDOM_PLANTS);
            writeln!(out, "\nlimits of {law} on {}", part.unwrap_or("the random plants"))?;
            mine.iter().try_for_each(|judged| writeln!(out, "{}", limit(judged)))?;
        }
        write!(out, "{verdict}")
    }
}

fn limit(judged: &Judged) -> String {
    let quantile = match judged.quantile {
        Some(1.0) | None => "max".to_owned(),
        Some(quantile) => format!("p{:.0}", 100.0 * quantile),
    };
    let Some(criterion) = Criterion::of(&judged.column) else { return judged.to_string() };
    let what = format!("{}, {quantile}", criterion.name);
    let below = criterion.show(judged.below.unwrap_or(f64::NAN));
    let state = if judged.state == State::Met { "met" } else { "MISSED" };
    format!("{state:<6} {what:<28}{:>10}   < {below} {}", criterion.cell(judged.value), criterion.unit)
}

impl fmt::Display for Sweep {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { battery, name, unit, rows } = self;
        let swept = || battery.criteria().filter(|criterion| criterion.is_swept);
        let head = if unit.is_empty() { name.clone() } else { format!("{name}, {unit}") };
        // The longest name of a column, with a space.
        let width = if *battery == Battery::Hard { 17 } else { 13 };
        write!(out, "{head:<34}")?;
        swept().try_for_each(|criterion| write!(out, "{:>width$}", criterion.name))?;
        write!(out, "\n{:<34}", "")?;
        swept().try_for_each(|criterion| write!(out, "{:>width$}", criterion.unit))?;
        let mut last = None;
        for SweepRow { value, law, cells, .. } in rows {
            let head = if last.replace(value) == Some(value) { "" } else { value };
            write!(out, "\n{head:<18}{law:<16}")?;
            for (criterion, cell) in swept().zip(cells) {
                write!(out, "{:>width$}", criterion.cell(*cell))?;
            }
        }
        for SweepRow { value, law, end, .. } in rows.iter().filter(|row| row.end != End::Complete.to_string())
        {
            write!(out, "\n{law} at {value} {unit}: {end}")?;
        }
        Ok(())
    }
}
