//! Tables of the drive: all columns from the code but the last, whose meanings are kept.

use std::f64::consts::TAU;

use lashloop_firmware::Laws;
use lashloop_firmware::drive::PinParameters;
use lashloop_firmware::law::{DriveParameters, LawSet, Parameter, ParameterGroup, Signal};

/// Most counts that an encoder may move between two samples without ambiguity.
const LARGEST_MOVE: f64 = ((1 << 23) - 1) as f64;

/// The columns of a table.
struct Columns {
    header: &'static [&'static str],
    /// Columns whose cells together tell a row from all others.
    key: &'static [usize],
}

/// A part of the annex of the Lashloop drive.
pub fn of_drive(name: &str, old: &str) -> Option<String> {
    let table = match name {
        "laws" => Columns { header: &["index", "name", "meaning"], key: &[1] }.filled(laws(), old),
        "signals" => {
            let header = &["index", "name", "unit", "laws", "meaning"];
            Columns { header, key: &[1] }.filled(signals(), old)
        }
        "parameters" => {
            let header =
                &["index", "name", "unit", "type", "default", "min", "max", "laws", "live", "meaning"];
            Columns { header, key: &[1] }.filled(parameters(), old)
        }
        "choices" => {
            let header = &["parameter", "value", "name", "meaning"];
            Columns { header, key: &[0, 2] }.filled(choices(), old)
        }
        "longest gap" => longest_gap_table(),
        _ => return of_bench_mode(name, old),
    };
    Some(table)
}

/// The first parameter of bench mode that the contract doesn't ask for; nor does it ask for those behind it.
const FIRST_OWN: &str = "encoder_filter_ns";

/// A part of the annex of bench mode, or of that of the Lashloop drive.
pub fn of_bench_mode(name: &str, old: &str) -> Option<String> {
    let header = &["name", "type", "default", "min", "max", "unit", "meaning"];
    let of = |it: &Parameter| {
        let [unit, ty, default, min, max] = description(it);
        vec![code(it.name), ty, default, min, max, unit]
    };
    let is_own = match name {
        "bench parameters" => false,
        "own bench parameters" => true,
        _ => return None,
    };
    let first_own = PinParameters::TABLE.iter().position(|it| it.name == FIRST_OWN)?;
    let (contract, own) = PinParameters::TABLE.split_at(first_own);
    let table = if is_own { own } else { contract };
    Some(Columns { header, key: &[0] }.filled(table.iter().map(of).collect(), old))
}

impl Columns {
    /// The table with these rows, each with the meaning that it has in the old table.
    fn filled(&self, rows: Vec<Vec<String>>, old: &str) -> String {
        let old: Vec<Vec<String>> = old.lines().map(cells).collect();
        let meaning = |row: &[String]| {
            let same = |it: &&Vec<String>| self.key.iter().all(|at| it.get(*at) == row.get(*at));
            old.iter().find(same).and_then(|it| it.last()).cloned().unwrap_or_default()
        };
        let rows = rows.into_iter().map(|mut row| {
            let meaning = meaning(&row);
            row.push(meaning);
            line(&row)
        });
        let header = line(&self.header.iter().map(|it| (*it).to_owned()).collect::<Vec<_>>());
        let rule = format!("|{}", "---|".repeat(self.header.len()));
        [header, rule].into_iter().chain(rows).collect::<Vec<_>>().join("\n")
    }
}

fn cells(line: &str) -> Vec<String> {
    line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

fn line(cells: &[String]) -> String {
    let cell = |it: &String| if it.is_empty() { " |".to_owned() } else { format!(" {it} |") };
    format!("|{}", cells.iter().map(cell).collect::<String>())
}

fn code(name: &str) -> String {
    format!("`{name}`")
}

/// The laws of a mask.
fn laws_of(mask: u16) -> String {
    if mask.count_ones() as usize == Laws::NAMES.len() {
        return "all".to_owned();
    }
    let named = Laws::NAMES.iter().enumerate().filter(|(index, _)| mask >> index & 1 == 1);
    named.map(|(_, name)| code(name)).collect::<Vec<_>>().join(", ")
}

fn laws() -> Vec<Vec<String>> {
    Laws::NAMES.iter().enumerate().map(|(index, name)| vec![index.to_string(), code(name)]).collect()
}

fn signals() -> Vec<Vec<String>> {
    let row = |(index, it): (usize, &Signal)| {
        vec![index.to_string(), code(it.name), it.unit.to_owned(), laws_of(it.laws)]
    };
    Laws::SIGNALS.iter().enumerate().map(row).collect()
}

/// Unit, type, default, smallest and largest value.
fn description(parameter: &Parameter) -> [String; 5] {
    let range = parameter.range;
    let values = [range.default(), range.min(), range.max()].map(|value| value.to_string());
    let [default, min, max] = values;
    [parameter.unit.to_owned(), range.default().ty().to_string(), default, min, max]
}

fn parameters() -> Vec<Vec<String>> {
    let row = |(index, it): (usize, &Parameter)| {
        let live = if it.live { "yes" } else { "" };
        let described = [index.to_string(), code(it.name)].into_iter().chain(description(it));
        described.chain([laws_of(it.laws), live.to_owned()]).collect()
    };
    Laws::PARAMETERS.iter().enumerate().map(row).collect()
}

fn choices() -> Vec<Vec<String>> {
    let named = |parameter: &'static Parameter| {
        let names = parameter.range.choices().unwrap_or_default().iter().enumerate();
        names.map(move |(value, name)| vec![code(parameter.name), value.to_string(), code(name)])
    };
    Laws::PARAMETERS.iter().flat_map(named).collect()
}

/// Counts of the motor encoder per control period at its speed limit, and the longest gap in periods, with default parameters.
pub fn longest_gap() -> (f64, u16) {
    let parameters = DriveParameters::default();
    let speed = f64::from(parameters.motor_speed_limit_rad_s);
    let period_s = f64::from(parameters.period_us) * 1e-6;
    let counts_per_period = speed * period_s * f64::from(parameters.motor_counts_per_rev) / TAU;
    let is_unambiguous = |periods: &u16| f64::from(*periods) * counts_per_period + 1.0 <= LARGEST_MOVE;
    let longest = (1..).take_while(is_unambiguous).last().expect("one period is unambiguous");
    (counts_per_period, longest)
}

fn longest_gap_table() -> String {
    let (counts_per_period, longest) = longest_gap();
    format!(
        "| encoder | counts per period | longest gap, periods |\n|---|---|---|\n\
         | motor | {counts_per_period:.0} | {longest} |"
    )
}
