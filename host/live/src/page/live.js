// The page of a run that hasn't ended: messages of the feed to charts, table and verdict. All texts are set as text, never as HTML.
"use strict";

(() => {
  const RETRIES = 5;
  const RETRY_MS = 1500;
  const at = (id) => document.getElementById(id);
  const STANDINGS = {
    met: ["met", "pass"],
    within: ["met so far", "pass"],
    beyond: ["not met so far", "marginal"],
    missed: ["missed", "fail"],
    open: ["no value yet", "none"],
  };

  // The latest buckets of one history, as many as the bench keeps: least and greatest value at the same time.
  function samples(columns, buckets) {
    const kept = 2 * buckets;
    const time = new Float64Array(2 * kept);
    const values = columns.map(() => new Float32Array(2 * kept));
    let end = 0;
    const latest = (array) => array.subarray(Math.max(end - kept, 0), end);
    return {
      push(bucket) {
        if (end === 2 * kept) {
          for (const array of [time, ...values]) array.copyWithin(0, kept);
          end = kept;
        }
        time.fill(bucket[0], end, end + 2);
        values.forEach((column, index) => {
          column[end] = bucket[1 + 2 * index];
          column[end + 1] = bucket[2 + 2 * index];
        });
        end += 2;
      },
      // Breaks the curves where buckets are missing.
      gap() {
        if (end) this.push([time[end - 1], ...columns.flatMap(() => [NaN, NaN])]);
      },
      time() { return latest(time); },
      column(index) { return latest(values[index]); },
    };
  }

  // The whole run, and from the first time of the finer history on that one.
  function joined(histories, of) {
    const [whole, recent] = histories;
    const from = recent?.time().at(0);
    if (from === undefined) return of(whole);
    const head = of(whole).subarray(0, LashloopScale.lowerBound(whole.time(), from));
    const tail = of(recent);
    const all = new tail.constructor(head.length + tail.length);
    all.set(head);
    all.set(tail, head.length);
    return all;
  }

  let run = null; // what the present connection has received
  let isOver = false;
  let retries = 0;
  let socket = null;
  let windowS = 0;

  function describe(text) {
    document.title = `${text.title} \u2013 Lashloop live`;
    at("title").textContent = text.title;
    at("charts").replaceChildren();
    at("panels").replaceChildren();
    at("controls").hidden = false;
    const group = LashloopCharts.group(0, 1e-3);
    const charts = text.panels.map((panel) => {
      const host = at("charts").appendChild(document.createElement("div"));
      choice(host, panel);
      const curves = panel.curves.flatMap((it) => (it.role === "limits" ? [[it, 1, `upper ${it.label}`], [it, -1, `lower ${it.label}`]] : [[it, 1, it.label]]));
      const series = curves.map(([it, sign, name]) => ({
        name,
        style: { measured: "c0", drive: "c1", reference: "reference", limits: "limit" }[it.role],
        isDashed: it.role === "reference",
        column: it.column, sign, x: [], y: [],
      }));
      const range = panel.is_enlarged ? () => enlarged(series.find((it) => it.style === "limit").y) : null;
      LashloopCharts.chart(host, { group, title: panel.title, unit: panel.unit, series, range });
      return series;
    });
    group.listen(({ cursor }) => {
      at("cursor-time").textContent = cursor === null ? "" : `cursor at ${LashloopScale.readOut(cursor, group.view[1] - group.view[0])} s`;
    });
    run = { text, group, charts, histories: text.histories.map((buckets) => samples(text.columns, buckets)), places: [] };
    facts([["scenario", text.scenario], ["drive", text.device], ["law", text.controller], ["clock", text.clock]]);
    badge("LIVE", "none", "The run continues.");
    at("stop").disabled = false;
  }

  // A vertical range that the largest limit so far fills; null before there is one.
  function enlarged(limits) {
    const limit = 1.25 * LashloopScale.range(limits, 0, limits.length)?.[1];
    return limit > 0 ? [-limit, limit] : null;
  }

  // A button that opens and closes a panel.
  function choice(host, panel) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: panel.title });
    const show = (isOpen) => {
      host.hidden = !isOpen;
      button.setAttribute("aria-pressed", String(isOpen));
    };
    button.addEventListener("click", () => {
      show(host.hidden);
      run.group.redraw();
    });
    show(panel.is_open);
    at("panels").append(button);
  }

  function take(buffer) {
    const [number, first] = new Uint32Array(buffer, 0, 2);
    const history = run.histories[number];
    const row = 1 + 2 * run.text.columns.length;
    const values = new Float32Array(buffer, 8);
    if (run.places[number] < first) history.gap();
    for (let start = 0; start < values.length; start += row) history.push(values.subarray(start, start + row));
    run.places[number] = first + values.length / row;
    const time = joined(run.histories, (it) => it.time());
    for (const it of run.charts.flat()) {
      const column = joined(run.histories, (samples) => samples.column(it.column));
      it.x = time;
      it.y = it.sign < 0 ? column.map((value) => -value) : column;
    }
    const end = time.at(-1) ?? 0;
    run.group.extend(end);
    if (windowS > 0) run.group.setView(end - windowS, end);
    run.group.redraw();
    at("progress").value = Math.min(end / run.text.duration_s, 1);
  }

  function facts(pairs) {
    const nodes = pairs.map(([name, value]) => {
      const pair = document.createElement("div");
      pair.append(Object.assign(document.createElement("dt"), { textContent: name }));
      pair.append(Object.assign(document.createElement("dd"), { textContent: value }));
      return pair;
    });
    at("facts").replaceChildren(...nodes);
  }

  function badge(text, tone, why) {
    at("badge").textContent = text;
    at("verdict").className = `verdict ${tone}`;
    if (at("why").textContent !== why) at("why").textContent = why;
  }

  function expectations(lines) {
    const rows = lines.map((line) => {
      const row = document.createElement("tr");
      const cell = (text, className, name = "td") => {
        const node = Object.assign(document.createElement(name), { textContent: text, className });
        row.append(node);
        return node;
      };
      cell(line.window ? `${line.quantity}, ${line.window}` : line.quantity, "", "th").scope = "row";
      cell(line.value, "number").dataset.label = "value";
      cell(line.bounds, "number").dataset.label = "limit";
      const [text, tone] = STANDINGS[line.standing];
      cell(text, `live-tone ${tone}`);
      return row;
    });
    at("expectations").replaceChildren(...rows);
  }

  const digits = (value, count) => LashloopScale.minus(Number(value).toFixed(count));

  function show(status) {
    const { text } = run;
    const quantiles = status.quantiles_us.map(([name, it]) => [`${name} p99`, `${digits(it.p99, 0)} us`]);
    facts([
      ["time", `${digits(status.simulated_s, 1)} s of ${text.duration_s} s`],
      ["rate", `${digits(status.rate, status.rate < 10 ? 1 : 0)} times real time`],
      ["unanswered", status.unanswered], ["missed", status.missed], ...quantiles,
      ["drive", text.device], ["law", text.controller], ["clock", text.clock],
    ]);
    expectations(status.expectations);
    const why = status.breaches.length ? status.breaches.join("; ") : `So far: ${status.phrase}.`;
    badge(status.decided ? `${status.decided} so far` : "LIVE", status.decided ? status.decided.toLowerCase() : "none", why);
  }

  function end(ending) {
    isOver = true;
    at("stop").disabled = true;
    connection("the run has ended");
    expectations(ending.expectations);
    const how = ending.end === "complete" ? "The run is complete." : "The run ended early.";
    const record = ending.record
      ? ` The record is in ${ending.record}; lashloop report ${ending.record} makes its page.`
      : " No record was kept; run with --out DIR for one.";
    const reasons = ending.reasons.map((it) => ` ${it}.`).join("");
    badge(ending.verdict, ending.verdict.toLowerCase(), how + reasons + record);
  }

  function fail() {
    isOver = true;
    at("stop").disabled = true;
    connection("the bench has ended");
    badge("NO VERDICT", "invalid", "The run failed. The terminal of the bench has the reason.");
  }

  const connection = (text) => (at("connection").textContent = text);

  function connect() {
    socket = new WebSocket(`ws://${location.host}/feed${location.search}`);
    socket.binaryType = "arraybuffer";
    socket.addEventListener("open", () => connection("connected"));
    socket.addEventListener("message", ({ data }) => {
      retries = 0;
      if (typeof data !== "string") return take(data);
      const text = JSON.parse(data);
      ({ description: describe, status: show, end, failed: fail })[text.kind](text);
    });
    socket.addEventListener("close", () => {
      if (isOver) return;
      at("stop").disabled = true;
      if (retries++ < RETRIES) {
        connection("connection lost, connecting again");
        setTimeout(connect, RETRY_MS);
      } else {
        connection("connection lost");
        badge("LOST", "invalid", "The bench does not answer. Its terminal has the state of the run; reload to try again.");
      }
    });
  }

  at("stop").addEventListener("click", () => {
    socket.send("stop");
    at("stop").disabled = true;
    connection("stop requested");
  });
  const windows = [...document.querySelectorAll("[data-window]")];
  windows.forEach((button) => button.addEventListener("click", () => {
    windowS = Number(button.dataset.window);
    windows.forEach((it) => it.setAttribute("aria-pressed", String(it === button)));
    if (!run) return;
    if (windowS > 0) run.group.setView(run.group.extent[1] - windowS, run.group.extent[1]);
    else run.group.reset();
  }));
  connect();
})();
