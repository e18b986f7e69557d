//! `lashloop run --live` with clients that read, that don't, and that have no business here.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use lashloop_record::reader::Record;
use serde_json::Value;
use tempfile::TempDir;
use tungstenite::client::IntoClientRequest;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

use crate::support::{LASHLOOP, lashloop, root, text};

/// A run on the in-process drive that waits for a first reader.
struct Run {
    folder: TempDir,
    child: Child,
    /// `HOST:PORT/?token=...`
    url: String,
}

type Client = WebSocket<MaybeTlsStream<TcpStream>>;

impl Run {
    fn start(duration_s: f64, options: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new(LASHLOOP);
        command.args(arguments(duration_s, folder.path())).args(["--live-wait", "60"]);
        command.args(if options.iter().any(|it| it.starts_with("--live=")) { &[][..] } else { &["--live"] });
        let mut child = command.args(options).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        child.stdout = Some(output.into_inner());
        let url = line.trim().strip_prefix("live        http://").unwrap_or_else(|| panic!("{line:?}"));
        Self { folder, child, url: url.to_owned() }
    }

    fn connect(&self) -> Client {
        let (authority, query) = self.url.split_once('/').unwrap();
        tungstenite::connect(format!("ws://{authority}/feed{query}")).unwrap().0
    }

    /// Connects as Foxglove does, with these headers.
    fn connect_client(&self, headers: &[(&'static str, &str)]) -> Result<Client, tungstenite::Error> {
        let mut request = format!("ws://{}", self.url).into_client_request().unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        tungstenite::connect(request).map(|(client, _)| client)
    }

    /// Memory that the bench holds, in bytes.
    fn resident_bytes(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
        1024 * line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap()
    }

    /// The status line of the answer to `GET path` with these headers.
    fn get(&self, path: &str, headers: &[&str]) -> String {
        let port = self.url.split_once('/').unwrap().0.rsplit_once(':').unwrap().1;
        let mut stream = TcpStream::connect(format!("127.0.0.1:{port}")).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        let lines = headers.iter().map(|header| format!("{header}\r\n")).collect::<String>();
        write!(stream, "GET {path} HTTP/1.1\r\nConnection: close\r\n{lines}\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer.lines().next().unwrap_or_default().to_owned()
    }

    /// Waits for the end of the program. Returns its exit code and the summary of the run.
    fn end(self) -> (Option<i32>, Value) {
        let Output { status, .. } = self.child.wait_with_output().unwrap();
        (status.code(), summary(self.folder.path()))
    }
}

fn arguments(duration_s: f64, folder: &Path) -> Vec<String> {
    let scenario = root().join("scenarios/smooth-after.toml");
    let settings = ["expect=[]", "allow.late=1000000", "controller.parameters.watchdog_us=60000000"];
    let mut arguments = vec!["run".to_owned(), scenario.display().to_string()];
    arguments.extend(["--device".to_owned(), "inproc".to_owned()]);
    arguments.extend(["--out".to_owned(), folder.display().to_string()]);
    let duration = format!("run.duration_s={duration_s}");
    let all = settings.iter().copied().chain([duration.as_str()]);
    arguments.extend(all.flat_map(|setting| ["--set".to_owned(), setting.to_owned()]));
    arguments
}

fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("summary.json")).unwrap()).unwrap()
}

/// What a client has received, up to the end.
#[derive(Default)]
struct Received {
    texts: Vec<Value>,
    /// Number of the history, number of the first bucket, and the buckets.
    samples: Vec<(u32, u32, Vec<f32>)>,
}

impl Received {
    /// Reads messages until `is_enough`, or the server closes.
    fn read(client: &mut Client, is_enough: impl Fn(&Self) -> bool) -> Self {
        let mut received = Self::default();
        while !is_enough(&received) {
            match client.read() {
                Ok(Message::Text(text)) => received.texts.push(serde_json::from_str(&text).unwrap()),
                Ok(Message::Binary(bytes)) => {
                    let words: Vec<[u8; 4]> =
                        bytes.chunks_exact(4).map(|word| word.try_into().unwrap()).collect();
                    let [history, first] = [0, 1].map(|at| u32::from_le_bytes(words[at]));
                    received.samples.push((
                        history,
                        first,
                        words[2..].iter().map(|word| f32::from_le_bytes(*word)).collect(),
                    ));
                }
                Ok(Message::Close(_)) | Err(tungstenite::Error::ConnectionClosed) => break,
                Ok(other) => panic!("{other:?}"),
                Err(error) => panic!("{error}"),
            }
        }
        received
    }

    fn kinds(&self) -> Vec<&str> {
        self.texts.iter().map(|text| text["kind"].as_str().unwrap()).collect()
    }

    /// The buckets of the whole run, each with time and pairs of values.
    fn buckets(&self) -> Vec<Vec<f32>> {
        let columns = self.texts[0]["columns"].as_array().unwrap().len();
        let mut next = 0;
        let mut buckets = Vec::new();
        for (_, first, values) in self.samples.iter().filter(|(history, ..)| *history == 0) {
            assert_eq!(*first as usize, next, "no bucket is missing");
            buckets.extend(values.chunks_exact(1 + 2 * columns).map(<[f32]>::to_vec));
            next = buckets.len();
        }
        buckets
    }
}

#[test]
fn a_reader_gets_every_extreme_of_the_run_and_its_end() {
    let run = Run::start(5.0, &[]);
    let received = Received::read(&mut run.connect(), |_| false);
    let trace = Record::read(run.folder.path()).unwrap().trace;
    let record = run.folder.path().display().to_string();
    let (code, summary) = run.end();
    assert_eq!(code, Some(0));

    assert_eq!((received.kinds()[0], *received.kinds().last().unwrap()), ("description", "end"));
    let end = received.texts.last().unwrap();
    assert_eq!((&end["verdict"], &end["record"]), (&summary["verdict"], &Value::String(record)));
    let last_status = &received.texts[received.texts.len() - 2];
    assert_eq!(last_status["steps"], summary["steps"]);

    // 5000 steps in buckets of two.
    let buckets = received.buckets();
    assert_eq!(buckets.len(), 2_500);
    assert_eq!((buckets[0][0], buckets[1][0]), (0.0, 0.002));
    let columns = received.texts[0]["columns"].as_array().unwrap();
    let column = columns.iter().position(|column| column["name"] == "torque_nm").unwrap();
    let torques_nm = trace.get("torque_nm").unwrap();
    assert_eq!(torques_nm.len(), 2 * buckets.len());
    for (bucket, pair) in buckets.iter().zip(torques_nm.chunks_exact(2)) {
        let extremes = [pair[0].min(pair[1]) as f32, pair[0].max(pair[1]) as f32];
        assert_eq!(bucket[1 + 2 * column..3 + 2 * column], extremes);
    }
}

#[test]
fn a_reader_that_takes_nothing_changes_neither_torque_nor_pace() {
    const DURATION_S: f64 = 25.0;
    let alone = tempfile::tempdir().unwrap();
    let arguments = arguments(DURATION_S, alone.path());
    let ended = lashloop(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), &[]);
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    let alone = summary(alone.path());

    let run = Run::start(DURATION_S, &[]);
    let silent = [(); 3].map(|()| run.connect());
    let (_, watched) = run.end();
    drop(silent);
    assert_eq!(watched["torque_sha256"], alone["torque_sha256"]);
    let [watched_s, alone_s] = [&watched, &alone].map(|summary| summary["wall_s"].as_f64().unwrap());
    // Machines are shared; a loop that waited for these readers would never end.
    assert!(watched_s < 10.0 * alone_s.max(0.1), "{watched_s} s with readers, {alone_s} s alone");
}

#[test]
fn a_late_reader_gets_the_history_and_a_stop_ends_the_run() {
    let run = Run::start(600.0, &["--clock", "real-time"]);
    let mut early = run.connect();
    Received::read(&mut early, |received| received.samples.len() > 10);
    let mut late = run.connect();
    let received =
        Received::read(&mut late, |received| !received.samples.is_empty() && received.texts.len() > 1);
    let buckets = received.buckets();
    assert_eq!(received.kinds(), ["description", "status"]);
    assert_eq!(buckets[0][0], 0.0, "the first bucket is that of the start");
    late.send(Message::text("stop")).unwrap();
    let rest = Received::read(&mut early, |_| false);
    let (code, summary) = run.end();
    assert_eq!((code, &summary["end"]), (Some(3), &Value::from("interrupted by the user")));
    assert_eq!(rest.texts.last().unwrap()["end"], summary["end"]);
}

#[test]
fn foreign_hosts_and_origins_are_refused() {
    let run = Run::start(0.1, &[]);
    let status = |path: &str, headers: &[&str]| run.get(path, headers).split(' ').nth(1).unwrap().to_owned();
    let upgrade = [
        "Host: localhost",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
    ];
    for path in ["/", "/live.js", "/live.css", "/feed"] {
        assert_eq!(status(path, &["Host: evil.example"]), "403", "{path}");
        assert_eq!(status(path, &["Host: localhost", "Origin: http://evil.example"]), "403", "{path}");
    }
    assert_eq!(status("/feed", &[&upgrade[..], &["Origin: http://localhost:3000"]].concat()), "403");
    for path in ["/", "/live.js", "/live.css"] {
        assert_eq!(status(path, &["Host: localhost", "Origin: http://localhost"]), "200", "{path}");
    }
    drop(run.connect());
    assert_eq!(run.end().0, Some(0));
}

#[test]
fn other_machines_need_the_token() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = arguments(0.1, folder.path());
    let open: Vec<&str> = arguments.iter().map(String::as_str).chain(["--live=0.0.0.0"]).collect();
    let refused = lashloop(&open, &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("add --live-token"), "{}", text(&refused.stderr));

    let run = Run::start(0.1, &["--live=127.0.0.1", "--live-token=0123456789abcdef"]);
    assert!(run.url.ends_with("/?token=0123456789abcdef"), "{}", run.url);
    let status = |path: &str| run.get(path, &["Host: bench-pc"]).split(' ').nth(1).unwrap().to_owned();
    for path in ["/", "/?token=0123456789abcdee", "/feed", "/feed?token="] {
        assert_eq!(status(path), "403", "{path}");
    }
    assert_eq!(status("/?token=0123456789abcdef"), "200");
    let mut client = run.connect();
    Received::read(&mut client, |_| false);
    let manifest = fs::read_to_string(run.folder.path().join("record.json")).unwrap();
    assert!(manifest.contains("--live-token=***") && !manifest.contains("0123456789abcdef"), "{manifest}");
    assert_eq!(run.end().0, Some(0));
}

#[test]
fn silent_connections_keep_nobody_out() {
    let run = Run::start(600.0, &["--clock", "real-time", "--live-token=0123456789abcdef"]);
    let authority = run.url.split_once('/').unwrap().0.to_owned();
    let silent: Vec<_> = (0..64).map(|_| TcpStream::connect(&authority).unwrap()).collect();
    // It waits until the server has closed one of them.
    let mut page = run.connect();
    Received::read(&mut page, |received| !received.samples.is_empty());
    drop(silent);
    page.send(Message::text("stop")).unwrap();
    assert_eq!(run.end().0, Some(3));
}

const SUBPROTOCOL: &str = "sec-websocket-protocol";

/// The status of the answer to a handshake that is refused.
fn refusal(answer: Result<Client, tungstenite::Error>) -> u16 {
    match answer {
        Err(tungstenite::Error::Http(answer)) => answer.status().as_u16(),
        other => panic!("{:?}", other.map(|_| "accepted")),
    }
}

#[test]
fn a_client_of_foxglove_is_asked_for_its_protocol_and_its_token() {
    let run = Run::start(0.1, &["--live-token=0123456789abcdef"]);
    let origin = ("origin", "https://app.foxglove.dev");
    assert_eq!(refusal(run.connect_client(&[(SUBPROTOCOL, "foxglove.sdk.v9")])), 400);
    assert_eq!(refusal(run.connect_client(&[])), 400);
    let mut client =
        run.connect_client(&[(SUBPROTOCOL, "foxglove.sdk.v1.1, foxglove.sdk.v1"), origin]).unwrap();
    let info: Value = serde_json::from_str(client.read().unwrap().to_text().unwrap()).unwrap();
    assert_eq!(info["op"], "serverInfo");
    drop(client);
    assert_eq!(run.end().0, Some(0));
    let open = Run::start(0.1, &[]);
    assert_eq!(refusal(open.connect_client(&[(SUBPROTOCOL, "foxglove.sdk.v1"), origin])), 403);
    drop(open.connect_client(&[(SUBPROTOCOL, "foxglove.sdk.v1")]).unwrap());
    assert_eq!(open.end().0, Some(0));
}

#[test]
fn clients_that_ask_and_ping_and_never_read_take_their_bound_and_no_more() {
    const FRAMES: usize = 400_000;
    let run = Run::start(600.0, &["--clock", "real-time"]);
    let mut page = run.connect();
    Received::read(&mut page, |received| !received.samples.is_empty());
    let foxglove = || run.connect_client(&[(SUBPROTOCOL, "foxglove.sdk.v1")]).unwrap();
    let mut hostile = [run.connect(), foxglove(), foxglove()];
    let subscribe =
        |id: u32| format!(r#"{{"op":"subscribe","subscriptions":[{{"id":{id},"channelId":1}}]}}"#);
    for id in 0..100 {
        hostile[2].send(Message::text(subscribe(id))).unwrap();
    }
    let before = run.resident_bytes();
    for client in &mut hostile {
        let MaybeTlsStream::Plain(stream) = client.get_ref() else { panic!("no TLS here") };
        stream.set_write_timeout(Some(Duration::from_millis(500))).unwrap();
        // A ping of 125 bytes, and a request that isn't served: both are answered.
        let pings = [&[0x89, 0xfd, 0, 0, 0, 0][..], &[0; 125]].concat().repeat(100);
        let text = [&[0x81, 0x82, 0, 0, 0, 0][..], b"{}"].concat().repeat(100);
        let mut stream = stream;
        for frames in [&pings, &text].into_iter().cycle().take(FRAMES / 100) {
            // The bench drops such a client, or takes nothing more from it.
            if stream.write_all(frames).is_err() {
                break;
            }
        }
    }
    let grown = run.resident_bytes().saturating_sub(before);
    assert!(grown < 40 << 20, "{grown} bytes");
    let rest = Received::read(&mut page, |received| received.samples.len() > 10);
    assert!(rest.samples.len() > 10, "the run continues");
    page.send(Message::text("stop")).unwrap();
    assert_eq!(run.end().1["end"], Value::from("interrupted by the user"));
}

#[test]
fn a_slow_client_gets_every_step_of_a_run_that_has_long_ended_and_the_verdict() {
    let run = Run::start(25.0, &[]);
    let mut client = run.connect_client(&[(SUBPROTOCOL, "foxglove.sdk.v1")]).unwrap();
    let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]}"#;
    let (mut steps, mut last, began) = (0, String::new(), Instant::now());
    loop {
        match client.read() {
            Ok(Message::Text(text)) if text.contains(r#""op":"advertise""#) => {
                client.send(Message::text(subscribe)).unwrap();
            }
            Ok(Message::Text(text)) => text.as_str().clone_into(&mut last),
            Ok(Message::Binary(_)) => steps += 1,
            _ => break,
        }
        if steps % 100 == 99 {
            std::thread::sleep(Duration::from_millis(12));
        }
    }
    // The server's time for one that takes nothing is a second.
    assert!(began.elapsed() > Duration::from_secs(2), "{:?}", began.elapsed());
    assert_eq!(steps, 25_000);
    assert!(last.contains(r#""op":"status""#) && last.contains("PASS"), "{last}");
    assert_eq!(run.end().0, Some(0));
}
