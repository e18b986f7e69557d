//! Several requests in one write, which most of the other checks send.

use super::writes::{MOST_BYTES, MOST_REQUESTS};
use crate::prelude::checks::*;

/// Frame of a sample, the longest request that a drive answers in every state with a session, in bytes.
const SAMPLE: usize = 19;
/// Frame of the read that ends every write.
const READ: usize = 9;
/// Writes of each kind.
const WRITES: usize = 3;

pub(super) fn checks() -> Vec<Check> {
    let name = "17 requests, or 320 bytes, in one write are answered in their order";
    vec![check("R1.3 R4.1", name, |client| {
        client.sends_alone = false;
        client.idle()?;
        let ended = (0..client.repetitions(WRITES)).try_for_each(|_| two_writes(client));
        if matches!(ended, Err(Failure::Rule { .. })) {
            client.sends_alone = true;
            "from here on every request is sent alone".clone_into(&mut client.note);
        }
        ended
    })]
}

/// As many requests as a drive takes, and as many bytes.
fn two_writes(client: &mut Client) -> RuleResult {
    let indices = 0..MOST_REQUESTS as u8 - 1;
    let reads: Vec<HostMessage> = indices.clone().map(|index| GetParameter { index }.into()).collect();
    let reported = client.burst(&reads)?.into_iter().map(|it| Some(of::<ParameterReport>(&it)?.index));
    equal("indices of the reports", indices.map(Some).collect::<Vec<_>>(), reported.collect())?;
    // The longest answers.
    let reads = vec![DescribeParameter { index: 0 }.into(); MOST_REQUESTS - 1];
    let kinds = vec!["ParameterDescription"; reads.len()];
    of_kinds("answers to DescribeParameter", &kinds, client.burst(&reads)?)?;
    let samples: Vec<HostMessage> =
        (0..(MOST_BYTES - READ) / SAMPLE).map(|sequence| sample(sequence as u16).into()).collect();
    let answers = client.burst(&samples)?;
    equal("answers to samples in Idle", vec!["TorqueAnswer"; samples.len()], names(&answers))
}
