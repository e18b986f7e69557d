//! The time of answers: all in bounds, and how they are spread.

use std::time::{Duration, Instant};

use lashloop_protocol::message::{DescribeParameter, EncoderSample, GetParameter, Hello};
use lashloop_protocol::sequence::of_step;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, PROTOCOL_VERSION};

use lashloop_bench::session::line::REQUEST_LIMIT;

use super::answers::sample;
use super::assertion::{Failure, expect};
use super::check::Check;
use super::client::Client;

/// Longest time for an answer. A drive needs some 100 us; this is for an emulator on a machine that is busy with
/// something else, so only a drive that hangs is beyond it.
pub const LIMIT: Duration = Duration::from_secs(1);

/// Round trips per kind of request.
const ROUNDS: u32 = 200;

pub(super) fn checks() -> Vec<Check> {
    vec![
        timed::<Hello>("Identity", |client, _| {
            Hello { protocol_version: PROTOCOL_VERSION, session: client.session() }.into()
        }),
        timed::<DescribeParameter>("ParameterDescription", |_, _| DescribeParameter { index: 0 }.into()),
        timed::<GetParameter>("ParameterReport", |_, _| GetParameter { index: 0 }.into()),
        timed::<EncoderSample>("TorqueAnswer", |_, round| sample(of_step(round)).into()),
    ]
}

fn timed<Request: Payload>(answer: &'static str, request: fn(&Client, u32) -> HostMessage) -> Check {
    let name = format!("every {} is answered within {} s", Request::LAYOUT.name, LIMIT.as_secs());
    Check::new("latency", name, move |client| {
        client.running(&[])?;
        let mut times = Vec::new();
        for round in 0..ROUNDS {
            times.push(round_trip(client, request(client, round), answer)?);
        }
        times.sort();
        let [median, high, longest] = [50, 99, 100].map(|percent| times[times.len() * percent / 100 - 1]);
        client.note(format!("median {}, 99 % {}, longest {} us", us(median), us(high), us(longest)));
        expect(longest <= LIMIT, format!("{answer} within {LIMIT:?}"), longest)
    })
}

fn us(time: Duration) -> u128 {
    time.as_micros()
}

fn round_trip(client: &mut Client, request: HostMessage, answer: &str) -> Result<Duration, Failure> {
    use lashloop_protocol::Message;
    let sent = Instant::now();
    client.line().send(&request).map_err(Failure::Session)?;
    let came = client.wait_for(REQUEST_LIMIT, |message: &DriveMessage| {
        (message.layout().name == answer).then(|| sent.elapsed())
    })?;
    came.ok_or_else(|| Failure::Rule {
        expected: format!("{answer} within {LIMIT:?}"),
        came: format!("nothing within {REQUEST_LIMIT:?}"),
    })
}
