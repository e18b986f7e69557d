//! Latency of answers: the limit, and quantiles for the note.

use lashloop_protocol::sequence::of_step;

use super::judge::ATTEMPTS;
use crate::prelude::checks::*;

/// Latency limit. A drive needs some 100 us; the limit leaves time for an emulator on a busy machine, so that only a hung
/// drive exceeds it.
pub const LIMIT: Duration = Duration::from_secs(1);

/// Round trips per kind of request.
const ROUNDS: usize = 50;
/// As above, on a slow line.
const FEWEST_ROUNDS: usize = 10;

pub(super) fn checks() -> Vec<Check> {
    vec![
        timed::<Hello>("Identity", |client, _| hello(client.session).into()),
        timed::<DescribeParameter>("ParameterDescription", |_, _| DescribeParameter { index: 0 }.into()),
        timed::<GetParameter>("ParameterReport", |_, _| GetParameter { index: 0 }.into()),
        timed::<EncoderSample>("TorqueAnswer", |_, round| sample(of_step(round)).into()),
    ]
}

fn timed<Request: Payload>(answer: &'static str, request: fn(&Client, u32) -> HostMessage) -> Check {
    let name = format!("every {} is answered within {} s", Request::LAYOUT.name, LIMIT.as_secs());
    check("R13.1", name, move |client| {
        client.running(&[])?;
        let mut times = Vec::new();
        for round in 0..client.repetitions(ROUNDS).max(FEWEST_ROUNDS) as u32 {
            times.push(round_trip(client, request(client, round), answer)?);
        }
        times.sort();
        let [median, high, longest] = [50, 90, 100].map(|percent| times[times.len() * percent / 100 - 1]);
        let [median_us, high_us, longest_us] = [median, high, longest].map(|time| time.as_micros());
        client.note = format!("median {median_us}, 90 % {high_us}, longest {longest_us} us");
        expect(longest <= LIMIT, format!("{answer} within {} s", LIMIT.as_secs()), longest)
    })
}

/// A machine that stands still does so now and then, a hung drive every time.
fn round_trip(client: &mut Client, request: HostMessage, answer: &str) -> Result<Duration, Failure> {
    let mut waited = Duration::MAX;
    for _ in 0..ATTEMPTS {
        let sent = client.line.now();
        let answers = client.request_to(request, answer)?;
        waited = waited.min(client.line.now().saturating_duration_since(sent));
        equal("answer", vec![answer], names(&answers))?;
        if waited <= LIMIT {
            break;
        }
    }
    Ok(waited)
}
