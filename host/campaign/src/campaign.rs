//! A campaign: its file, the scenarios of its variants, and what of it is run.

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

use lashloop_bench::regular_file;
use lashloop_bench::run::digest::sha256;
use lashloop_bench::scenario::cases::Cases;
use lashloop_bench::scenario::tables::GivenTables;
use lashloop_bench::scenario::{Override, Scenario, settings_file};
use lashloop_plant::Plants;
use lashloop_plant::reference::{Interpolation, Reference, Table};
use serde::{Deserialize, Serialize};
use toml_edit::DocumentMut;

use crate::error::{CampaignError, io_error};
use crate::file::CampaignFile;
use crate::plan::{Case, Plan};

/// A file that the campaign consists of, so that a case can be run again without it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Path as the campaign file names it, next to the path of the campaign file.
    pub path: String,
    pub text: String,
}

impl Source {
    #[must_use]
    pub fn sha256(&self) -> String {
        sha256(self.text.as_bytes())
    }
}

/// What of a campaign is run, instead of the file's own choice.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    pub seed: Option<u64>,
    /// Settings of every case.
    pub set: Vec<String>,
    /// All if empty.
    pub parts: Vec<String>,
    /// All if empty.
    pub variants: Vec<String>,
    /// Points of every sampled part.
    pub points: Option<u64>,
}

impl Selection {
    /// The selection as options of `campaign run`.
    #[must_use]
    pub fn options(&self) -> Vec<String> {
        let Self { seed, set, parts, variants, points } = self;
        let mut options = Vec::new();
        options.extend(seed.map(|seed| format!("--seed={seed}")));
        options.extend(set.iter().map(|set| format!("--set={set}")));
        options.extend((!parts.is_empty()).then(|| format!("--part={}", parts.join(","))));
        options.extend((!variants.is_empty()).then(|| format!("--variant={}", variants.join(","))));
        options.extend(points.map(|points| format!("--points={points}")));
        options
    }
}

/// A campaign whose cases can be made one by one.
#[derive(Debug, Clone)]
pub struct Campaign {
    pub file: CampaignFile,
    /// The campaign file, then the scenarios, then the tables of their references.
    pub sources: Vec<Source>,
    pub selection: Selection,
    pub variants: Vec<Variant>,
    pub plan: Plan,
    plants: Plants,
}

/// A variant with its scenario.
#[derive(Debug, Clone)]
pub struct Variant {
    pub name: String,
    /// Index of its scenario in the sources.
    source: usize,
    set: Vec<Override>,
    /// Keys of axes that the variant leaves as they are.
    omit: Vec<String>,
    /// The scenario, parsed once for all cases.
    parsed: Cases,
    /// The scenario without the settings of a case, every default included.
    base: DocumentMut,
}

/// Name of the only variant of a campaign without any.
const ONLY: &str = "default";

impl Campaign {
    /// Reads a campaign and its scenarios.
    ///
    /// # Errors
    /// A file can't be read or has errors, or the selection names what the campaign lacks.
    pub fn read(path: &Path, selection: Selection, plants: &Plants) -> Result<Self, CampaignError> {
        let read = |path: &str, kind| {
            let text = settings_file::read_text(Path::new(path), kind)?;
            Ok::<_, CampaignError>(Source { path: path.to_owned(), text })
        };
        let file = read(&path.to_string_lossy(), "campaign file")?;
        let mut sources = vec![file];
        for scenario in scenarios(&CampaignFile::from_str(&sources[0].path, &sources[0].text)?) {
            let path = next_to(&sources[0].path, &scenario);
            if sources.iter().all(|source| source.path != path) {
                sources.push(read(&path, "scenario")?);
            }
        }
        let (campaign, tables) = Self::build(sources.clone(), selection.clone(), plants)?;
        if tables.is_empty() {
            return Ok(campaign);
        }
        // Again with the texts, so that every case has the points whose hash is among the facts.
        for table in tables {
            let text = regular_file::read_text(&table).map_err(io_error(&table, "read"))?;
            sources.push(Source { path: table.to_string_lossy().into_owned(), text });
        }
        Self::from_sources(sources, selection, plants)
    }

    /// A campaign of these texts.
    ///
    /// # Errors
    /// As [`read`](Self::read), apart from reading.
    pub fn from_sources(
        sources: Vec<Source>,
        selection: Selection,
        plants: &Plants,
    ) -> Result<Self, CampaignError> {
        Ok(Self::build(sources, selection, plants)?.0)
    }

    /// A campaign, and the reference tables that it needs.
    fn build(
        sources: Vec<Source>,
        selection: Selection,
        plants: &Plants,
    ) -> Result<(Self, BTreeSet<PathBuf>), CampaignError> {
        let Some(Source { path, text }) = sources.first() else {
            return Err(unusable("campaign", "has no text".to_owned()));
        };
        let path = path.clone();
        let mut file = CampaignFile::from_str(&path, text)?;
        let scenarios: Vec<_> = scenarios(&file).iter().map(|scenario| next_to(&path, scenario)).collect();
        select(&mut file, &selection).map_err(|problem| unusable(&path, problem))?;
        let variants = variants(&file, &path, &sources, &scenarios, &selection, plants)?;
        let plan =
            Plan::new(file.seed, &file.parts, variants.len(), |variant, key| variants[variant].number(key));
        let plan = plan.map_err(|problem| unusable(&path, problem))?;
        let campaign = Self { file, sources, selection, variants, plan, plants: plants.clone() };
        let tables = campaign.check_values()?;
        Ok((campaign, tables))
    }

    /// A case and its settings, each as after `--set`.
    ///
    /// # Errors
    /// The campaign has no such case.
    pub fn case(&self, number: u64) -> Result<Case, CampaignError> {
        let cases = self.plan.cases();
        if number >= cases {
            return Err(CampaignError::NoCase { case: number, last: cases.saturating_sub(1) });
        }
        Ok(self.plan.case(number))
    }

    /// The first case of a part and variant.
    #[must_use]
    pub fn first_case(&self, part: usize, variant: usize) -> Case {
        let rows: u64 = (0..part).map(|part| self.plan.rows(part)).sum();
        self.plan.case(rows * self.variants.len() as u64 + variant as u64)
    }

    /// What a case sets in the scenario of its variant.
    #[must_use]
    pub fn overrides(&self, case: &Case) -> Vec<Override> {
        self.variants[case.variant].set.iter().cloned().chain(self.varied(case)).collect()
    }

    /// What a case sets in addition to its variant.
    #[must_use]
    pub fn varied(&self, case: &Case) -> Vec<Override> {
        let part = &self.file.parts[case.part];
        let axes = part.axes.iter().zip(&case.values);
        let varied = axes.flat_map(|(axis, value)| {
            let value = value.setting();
            let has = |key: &&String| !self.variants[case.variant].omit.contains(*key);
            axis.keys.iter().filter(has).map(move |key| Override::Set(format!("{key}={value}")))
        });
        part.set.iter().cloned().map(Override::Set).chain(varied).collect()
    }

    /// The scenario of a case.
    ///
    /// # Errors
    /// The scenario rejects a setting of the case.
    pub fn scenario(&self, case: &Case) -> Result<Scenario, CampaignError> {
        let scenario = self.variants[case.variant].parsed.scenario_with(&self.varied(case));
        scenario.map_err(|source| {
            let place = self.place(case, format_args!("case {}", case.number));
            CampaignError::Case { place, source }
        })
    }

    /// A case in errors.
    fn place(&self, case: &Case, what: fmt::Arguments<'_>) -> String {
        let file = self.sources.first().map_or("campaign", |source| &source.path);
        let part = &self.file.parts[case.part].name;
        format!("{file}: part {part}, variant {}, {what}", self.variants[case.variant].name)
    }

    /// The scenario file of a case.
    #[must_use]
    pub fn scenario_source(&self, case: &Case) -> &Source {
        &self.sources[self.variants[case.variant].source]
    }

    #[must_use]
    pub const fn plants(&self) -> &Plants {
        &self.plants
    }

    /// The number of a key in a case: that of its axis, that which its part sets, or that of the scenario.
    #[must_use]
    pub fn number(&self, case: &Case, key: &str) -> Option<f64> {
        let (part, variant) = (&self.file.parts[case.part], &self.variants[case.variant]);
        let is_omitted = variant.omit.iter().any(|omitted| omitted == key);
        let axis = part.axes.iter().position(|axis| axis.keys.iter().any(|it| it == key));
        if let Some(axis) = axis.filter(|_| !is_omitted) {
            return case.values[axis].number();
        }
        let set = part.set.iter().rev().filter_map(|setting| setting.split_once('='));
        let mut set = set.filter(|(name, _)| name.trim() == key);
        set.next().map_or_else(|| variant.number(key), |(_, value)| value.trim().parse().ok())
    }

    /// Makes a scenario with each listed value and each end of a range, so that a wrong one ends a campaign before its first
    /// run. Returns the reference tables of these scenarios.
    fn check_values(&self) -> Result<BTreeSet<PathBuf>, CampaignError> {
        let mut tables = BTreeSet::new();
        for (part, settings) in self.file.parts.iter().enumerate() {
            for (variant, Variant { parsed, .. }) in self.variants.iter().enumerate() {
                for (axis, case) in self.plan.probes(part, variant) {
                    let scenario = match axis {
                        None => self.scenario(&case),
                        Some(axis) => parsed.scenario_with(&self.varied(&case)).map_err(|source| {
                            let (name, value) = (settings.axes[axis].name(), &case.values[axis]);
                            let place = self.place(&case, format_args!("axis {name} at {value}"));
                            CampaignError::Case { place, source }
                        }),
                    };
                    if let Reference::Table(table) = scenario?.reference {
                        tables.insert(table.file().to_owned());
                    }
                }
            }
        }
        Ok(tables)
    }
}

impl Variant {
    fn number(&self, key: &str) -> Option<f64> {
        let item =
            key.split('.').try_fold(self.base.as_item(), |item, step| match step.parse::<usize>() {
                Ok(index) if item.is_array_of_tables() || item.is_array() => item.get(index),
                _ => item.get(step),
            })?;
        item.as_float().or_else(|| item.as_integer().map(|number| number as f64))
    }
}

fn unusable(file: &str, problem: String) -> CampaignError {
    CampaignError::Unusable { file: file.to_owned(), problem }
}

/// The scenarios of a campaign's variants, as its file names them.
fn scenarios(file: &CampaignFile) -> Vec<String> {
    let of_variants = file.variants.iter().filter_map(|variant| variant.scenario.clone());
    file.scenario.iter().cloned().chain(of_variants).collect()
}

/// A path that is relative to the campaign file.
fn next_to(campaign: &str, path: &str) -> String {
    let folder = Path::new(campaign).parent().unwrap_or(Path::new(""));
    folder.join(path).to_string_lossy().into_owned()
}

/// Reduces the campaign to the selection.
fn select(file: &mut CampaignFile, selection: &Selection) -> Result<(), String> {
    let Selection { seed, parts, variants, points, .. } = selection;
    let lacks = |what: &str, wanted: &[String], known: Vec<&str>| match wanted
        .iter()
        .find(|it| !known.contains(&it.as_str()))
    {
        Some(name) => Err(format!("has no {what} {name}; it has {}", known.join(", "))),
        None => Ok(()),
    };
    lacks("part", parts, file.parts.iter().map(|part| part.name.as_str()).collect())?;
    lacks("variant", variants, file.variants.iter().map(|variant| variant.name.as_str()).collect())?;
    let is_selected = |wanted: &[String], name: &String| wanted.is_empty() || wanted.contains(name);
    file.seed = seed.unwrap_or(file.seed);
    file.parts.retain(|part| is_selected(parts, &part.name));
    file.variants.retain(|variant| is_selected(variants, &variant.name));
    file.expectations.retain(|expectation| {
        expectation.part.iter().all(|name| is_selected(parts, name))
            && expectation.variant.iter().all(|name| is_selected(variants, name))
    });
    for part in file.parts.iter_mut().filter(|part| part.method.is_sampled()) {
        part.points = points.or(part.points);
    }
    let keys: Vec<_> = file.parts.iter().flat_map(|part| &part.axes).flat_map(|axis| &axis.keys).collect();
    let key_of = |setting: &str| setting.split('=').next().unwrap_or_default().trim().to_owned();
    match selection.set.iter().find(|setting| keys.contains(&&key_of(setting))) {
        Some(setting) => {
            Err(format!("varies the key of --set {setting}; select other parts, or omit the setting"))
        }
        None => Ok(()),
    }
}

fn variants(
    file: &CampaignFile,
    path: &str,
    sources: &[Source],
    scenarios: &[String],
    selection: &Selection,
    plants: &Plants,
) -> Result<Vec<Variant>, CampaignError> {
    let tables = sources.iter().skip(1).filter(|source| !scenarios.contains(&source.path)).map(|source| {
        let file = PathBuf::from(&source.path);
        let table = Table::from_text(&file, &source.text, Interpolation::Linear);
        let table = table.map_err(|error| unusable(path, error.to_string()))?;
        Ok((file, table))
    });
    let tables = tables.collect::<Result<GivenTables, CampaignError>>()?;
    let variant = |name: &str, scenario: Option<&String>, own: &[String], omit: &[String]| {
        let scenario = scenario.or(file.scenario.as_ref()).map(|scenario| next_to(path, scenario));
        let source = sources.iter().position(|source| Some(&source.path) == scenario.as_ref());
        let source = source
            .ok_or_else(|| unusable(path, format!("lacks the scenario {}", scenario.unwrap_or_default())))?;
        let set = file.set.iter().chain(own).chain(&selection.set);
        let set: Vec<_> = set.cloned().map(Override::Set).collect();
        let Source { path, text } = &sources[source];
        let parsed = Cases::from_str(path, text, &set, plants)?.with_tables(tables.clone());
        let base = parsed.scenario_with(&[])?;
        let base = base.to_toml().map_err(|error| unusable(path, error.to_string()))?;
        let base = base.parse().map_err(|error: toml_edit::TomlError| unusable(path, error.to_string()))?;
        Ok::<_, CampaignError>(Variant {
            name: name.to_owned(),
            source,
            set,
            omit: omit.to_vec(),
            parsed,
            base,
        })
    };
    if file.variants.is_empty() {
        return Ok(vec![variant(ONLY, None, &[], &[])?]);
    }
    file.variants.iter().map(|it| variant(&it.name, it.scenario.as_ref(), &it.set, &it.omit)).collect()
}
