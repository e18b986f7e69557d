//! What was run, and how to run it again.

use std::path::{self, Path};

use lashloop_bench::verdict::LinkCounts;
use lashloop_record::manifest::{Manifest, Number, ParameterInForce};
use lashloop_record::summary::Summary;
use maud::{Markup, html};

use super::super::input::Run;
use super::super::typeset;

pub(in super::super) fn section(run: &Run) -> Markup {
    html! {
        section #origin {
            h2 { "What was run" }
            (of_manifest(&run.record.manifest))
            @if let Some(summary) = &run.record.summary { (results(summary)) }
        }
    }
}

fn of_manifest(manifest: &Manifest) -> Markup {
    let host = &manifest.host;
    let facts = [
        ("processor", host.cpu.clone()),
        ("kernel", Some(host.kernel.clone())),
        ("governor", host.governor.clone()),
        ("clock source", host.clock_source.clone()),
    ];
    html! {
        h3 { "Settings of the command line" }
        @if manifest.overrides.is_empty() { p { "None: the scenario ran as its file has it." } } @else {
            div.scroll { table.overrides {
                thead { tr { th scope="col" { "key" } th scope="col" { "value" } th scope="col" { "file or default" } } }
                tbody { @for it in &manifest.overrides { tr {
                    th scope="row" { code { (it.key) } }
                    td { code { (it.value) } }
                    td { @match &it.was { Some(was) => code { (was) }, None => span.absent { "not set" } } }
                } } }
            } }
        }
        h3 { "Origin" }
        dl.origin {
            dt { "scenario" } dd { (manifest.scenario.name) br; code { (manifest.scenario.path) }
                @if let Some(hash) = &manifest.scenario.sha256 { br; code.hash { (hash) } } }
            dt { "started" } dd { (manifest.started) }
            dt { "command" } dd { code { (super::command::joined(&manifest.command_line)) } }
            @if let Some(folder) = &manifest.working_directory { dt { "working directory" } dd { code { (folder) } } }
            dt { "device" } dd { (manifest.device_description) }
            dt { "mode and clock" } dd { (if manifest.mode.is_hil() { "hil" } else { "bench" }) ", " (manifest.clock) ", period " (manifest.period_us) " \u{b5}s" }
            dt { "law" } dd { code { (manifest.law) } }
            dt { "seed" } dd { (manifest.seed) }
            dt { "lashloop" } dd { (manifest.versions.lashloop) ", " (manifest.evidence.bench_build) ", protocol " (manifest.versions.protocol) }
            dt { "firmware" } dd { (manifest.versions.firmware)
                @if let Some(build) = &manifest.versions.firmware_build { ", build " (build) }
                @if manifest.versions.firmware_dirty { " with changes" } }
            @for file in &manifest.evidence.files { (drive_file(&file.path, file.sha256.as_deref())) }
            @for warning in &manifest.evidence.warnings { dt { "warning" } dd.warning { (warning) } }
            dt { "host" }
            dd { (host.cores) " processors" @for (name, fact) in facts { @if let Some(fact) = fact { "; " (name) " " (fact) } } }
        }
        (parameters(&manifest.parameters))
    }
}

fn number(number: Number) -> String {
    match number {
        Number::Whole(value) => value.to_string(),
        Number::Real(value) => typeset::shown(f64::from(value)),
        unknown @ Number::Unknown { .. } => unknown.to_string(),
    }
}

/// The value of a parameter; of a choice its name.
pub(super) fn in_force(parameter: &ParameterInForce) -> String {
    parameter.choice.clone().unwrap_or_else(|| number(parameter.value))
}

/// Those that differ from the drive's defaults first.
fn parameters(all: &[ParameterInForce]) -> Markup {
    let (default, changed): (Vec<_>, Vec<_>) = all.iter().partition(|it| it.value == it.default);
    html! {
        h3 { "Parameters in force" }
        @if changed.is_empty() { p { "Each has the drive's default." } } @else {
            div.scroll { table.parameters {
                thead { tr { th scope="col" { "parameter" } th.number scope="col" { "value" } th scope="col" { "unit" } th.number scope="col" { "default" } } }
                tbody { @for it in changed { tr {
                    th scope="row" { code { (it.name) } }
                    td.number { (in_force(it)) }
                    td { (typeset::unit(&it.unit)) }
                    td.number { (number(it.default)) }
                } } }
            } }
        }
        @if !default.is_empty() {
            details {
                summary { (default.len()) " parameters at the drive's default" }
                p.note { @for (at, it) in default.iter().enumerate() {
                    @if at > 0 { ", " } code { (it.name) } " " (in_force(it)) " " (typeset::unit(&it.unit))
                } }
            }
        }
    }
}

fn drive_file(path: &str, sha256: Option<&str>) -> Markup {
    html! { dt { "file of the drive" } dd { code { (path) } @if let Some(sha256) = sha256 { br; code.hash { (sha256) } } } }
}

/// What identifies the result.
fn results(summary: &Summary) -> Markup {
    let LinkCounts {
        frames_sent,
        frames_received,
        crc_errors,
        lost,
        late,
        resumes,
        damaged_at_drive,
        overruns_at_drive,
    } = summary.link;
    html! {
        h3 { "Result" }
        dl.origin {
            dt { "digest of all torques" } dd { code.hash { (summary.torque_sha256) } }
            dt { "link" }
            dd {
                (frames_sent) " frames out, " (frames_received) " in; " (lost) " answers lost, " (late) " late; " (resumes) " times resumed; damaged: "
                (crc_errors) " frames here, " (damaged_at_drive) " frames and " (overruns_at_drive) " bytes at the drive"
            }
        }
    }
}

/// The command that repeats the run.
pub(in super::super) fn repeat(run: &Run) -> Markup {
    html! {
        section #repeat {
            h2 { "Run it again" }
            (super::command::copied(&rerun(run)))
            p.note { "The resolved scenario of the record with its device and its clock, compared with this run; options are in docs/comparing.md." }
        }
    }
}

/// The command that runs the scenario of a record again. A rig is given anew, because its limits are.
fn rerun(run: &Run) -> Vec<String> {
    let (folder, manifest) = (&run.record.folder, &run.record.manifest);
    let folder = path::absolute(folder).unwrap_or_else(|_| folder.clone());
    let mut words = vec!["lashloop".to_owned(), "rerun".to_owned(), folder.display().to_string()];
    if let Some(rig) = &manifest.rig {
        let rig = Path::new(manifest.working_directory.as_deref().unwrap_or_default()).join(rig);
        words.extend(["--rig".to_owned(), rig.display().to_string()]);
    } else if let Some(command) = manifest.device.strip_prefix("exec:") {
        // `rerun` starts no program by the record alone. A relative path began in the folder of the run.
        let is_relative = !command.starts_with(['/', '"', '\''])
            && command.split(' ').next().is_some_and(|it| it.contains('/'));
        let folder = manifest.working_directory.as_ref().filter(|_| is_relative);
        let folder = folder.map(|it| format!("{it}/")).unwrap_or_default();
        words.extend(["--device".to_owned(), format!("exec:{folder}{command}")]);
    }
    words
}
