//! Campaigns on Slurm: controller and node run on this machine, with jobs as users submit them.
//!
//! A checkout does not include Slurm, see [`optional`]. All trials share one cluster.

mod slurm;
mod submission;
mod trials;

use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::Arguments;
use slurm::Slurm;
use tests::optional;

type Check = fn(&Slurm);

const TRIALS: [(&str, Check); 8] = [
    ("an_array_of_seven_shards_gives_the_table_of_one_core", trials::same_table),
    ("a_killed_task_fails_the_merge_and_resumes_after_its_last_row", trials::killed_task),
    ("tasks_without_space_on_the_disk_resume_after_their_last_rows", trials::full_disk),
    ("a_constraint_waits_for_a_node_with_the_feature", trials::constraint),
    ("a_licence_is_taken_by_the_shards", trials::licence),
    ("another_campaign_or_build_in_a_folder_is_refused", trials::refused),
    ("the_page_about_clusters_leads_there", trials::page),
    ("without_slurm_the_missing_command_is_named", trials::no_slurm),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = slurm::missing();
    // On this thread: the daemons end with the one that starts them.
    let started = (missing.is_none() && !arguments.list).then(|| Slurm::start().map(Arc::new));
    let (slurm, failure) = match started {
        Some(Ok(slurm)) => (Some(slurm), None),
        Some(Err(error)) => (None, Some(format!("{error:#}"))),
        None => (None, None),
    };
    let trials = TRIALS.into_iter().map(|(name, check)| {
        let (slurm, failure) = (slurm.clone(), failure.clone());
        optional::trial(name, missing.clone(), move || match slurm {
            Some(slurm) => check(&slurm),
            None => panic!("{}", failure.unwrap_or_default()),
        })
    });
    optional::run(&arguments, "campaigns on Slurm", missing.as_deref(), trials.collect())
}
