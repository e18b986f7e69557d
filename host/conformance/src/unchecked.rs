//! The rules of the protocol without a check: the host's, each with the test that shows it, and those of the drive that no
//! request can show.
//!
//! A test of the repository compares the rules of the specification with those of the checks and of this table.

use std::fmt;

/// A rule without a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unchecked {
    /// Number of the rule, such as `H7.1`.
    pub rule: &'static str,
    /// What takes the place of a check.
    pub instead: Instead,
}

/// What takes the place of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instead {
    /// Nothing, for this reason.
    Nothing(&'static str),
    /// A test of the repository: file and name.
    Test {
        /// Path of the file in the repository.
        file: &'static str,
        /// Name of the test.
        name: &'static str,
    },
}

impl fmt::Display for Instead {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing(reason) => out.write_str(reason),
            Self::Test { file, name } => write!(out, "{file}: {name}"),
        }
    }
}

const fn nothing(rule: &'static str, reason: &'static str) -> Unchecked {
    Unchecked { rule, instead: Instead::Nothing(reason) }
}

const fn test(rule: &'static str, file: &'static str, name: &'static str) -> Unchecked {
    Unchecked { rule, instead: Instead::Test { file, name } }
}

const AT_THE_STAGE: &str = "only a meter at the power stage shows it";
const THE_ZERO_STAYS: &str = "no request restores the zero that the drive had";
const HOST_RULES: &str = "tests/tests/document/host_rules.rs";
const RETRIES: &str = "tests/tests/looped/retries.rs";
const LINK_FAULTS: &str = "tests/tests/looped/link_faults.rs";
const STREAM: &str = "protocol/tests/wire/stream.rs";
const PINNED: &str = "protocol/tests/wire/pinned_v1.rs";

/// All rules without a check, the drive's first.
pub const UNCHECKED: &[Unchecked] = &[
    nothing("R1.2", "only a USB device has transfers; no request shows their length"),
    nothing("R4.14", "no request makes a drive log while a torque is due"),
    nothing("R8.11", "no request halts a firmware"),
    nothing("R10.11", "an example: each of its sentences follows from another rule"),
    nothing("R18.8", "no request fills a transmit buffer in every drive"),
    nothing("R18.13", AT_THE_STAGE),
    nothing("R19.3", "the firmware would be gone: no check starts the boot loader of a drive that has one"),
    nothing("R19.4", AT_THE_STAGE),
    nothing("R20.6", "no request cuts the power in a store"),
    nothing("R20.7", "no request makes a memory fail in every drive"),
    nothing("R21.3", THE_ZERO_STAYS),
    nothing("R21.4", "no request closes a switch"),
    nothing("R21.5", THE_ZERO_STAYS),
    test("H1.1", RETRIES, "a_run_survives_the_loss_of_each_first_request"),
    test("H1.2", HOST_RULES, "one_request_is_pending_at_a_time"),
    test("H2.1", PINNED, "every_message_of_the_host_is_pinned"),
    test("H2.2", STREAM, "a_delimiter_after_garbage_preserves_the_next_frame"),
    test("H2.3", HOST_RULES, "the_first_byte_of_a_host_is_the_boundary_byte"),
    test("H3.1", "protocol/tests/wire/document.rs", "every_message_has_a_table_of_its_bytes"),
    test("H3.2", HOST_RULES, "what_a_newer_drive_adds_or_leaves_out_changes_nothing"),
    test(
        "H3.3",
        "tests/tests/looped/exit_codes.rs",
        "a_torque_beyond_the_limit_fails_the_run_with_rule_and_step",
    ),
    test(
        "H3.4",
        "host/session/src/description/tests.rs",
        "counts_that_no_drive_can_have_are_rejected_by_field",
    ),
    test("H3.5", STREAM, "fields_that_a_newer_peer_added_are_ignored"),
    test("H3.6", STREAM, "a_device_time_is_there_whole_or_not_at_all"),
    test("H4.1", HOST_RULES, "messages_in_between_change_nothing"),
    test("H4.2", HOST_RULES, "messages_in_between_change_nothing"),
    test("H4.3", HOST_RULES, "a_handshake_follows_a_reset"),
    test("H4.4", HOST_RULES, "messages_in_between_change_nothing"),
    test("H4.5", HOST_RULES, "requests_are_numbered_from_1_to_255_in_turn"),
    test("H4.6", HOST_RULES, "an_answer_with_another_number_is_dropped"),
    test("H7.1", LINK_FAULTS, "a_lost_answer_holds_the_torque_and_invalidates_the_run"),
    test("H7.2", "tests/tests/looped/exit_codes.rs", "a_latched_fault_fails_the_run_with_its_reason"),
    test("H7.3", RETRIES, "an_unanswered_first_sample_is_retransmitted_unchanged"),
    test("H7.4", "host/session/src/exchange.rs", "the_longest_gap_is_bridged_and_no_longer_one"),
    test("H7.5", "tests/tests/looped/wraparound.rs", "a_start_outside_the_encoder_range_is_rejected"),
    test("H8.1", "tests/tests/looped/fault_table.rs", "a_pause_in_lockstep_trips_no_watchdog"),
    test("H9.1", HOST_RULES, "names_and_not_indices_identify_parameters"),
    test("H9.2", "host/bench/tests/scenario/values.rs", "a_whole_number_may_have_an_exponent_or_a_point"),
    test("H9.3", HOST_RULES, "a_parameter_that_is_missing_or_refused_is_an_error"),
    test(
        "H10.1",
        "host/bench/src/run/drive_settings/tests.rs",
        "signals_are_subscribed_by_name_in_the_order_of_the_drive",
    ),
    test("H10.2", "host/session/src/laws.rs", "bits_of_laws_that_do_not_exist_are_ignored"),
    test("H12.1", HOST_RULES, "the_identity_of_another_session_is_not_accepted"),
    test("H12.2", HOST_RULES, "the_identity_of_another_session_is_not_accepted"),
    test("H12.3", RETRIES, "a_watchdog_trip_before_the_start_answer_is_retried"),
    test("H13.1", HOST_RULES, "the_time_limits_are_those_of_the_page"),
    test("H14.1", PINNED, "every_message_of_the_host_is_pinned"),
    test(
        "H14.2",
        "tests/tests/looped/connect_errors.rs",
        "a_drive_of_another_version_is_rejected_by_both_versions",
    ),
];
