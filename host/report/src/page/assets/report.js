// A report: its data to charts, and its controls.
"use strict";

(() => {
  const DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  const VALUES = new Uint8Array(128);
  for (let i = 0; i < 64; i++) VALUES[DIGITS.charCodeAt(i)] = i;

  // The values of an encoded column; `codec.rs` has the format.
  function decode({ offset, scale, order, digits }) {
    let at = 0;
    function token() {
      let value = 0;
      let factor = 1;
      for (;;) {
        const digit = VALUES[digits.charCodeAt(at++)];
        value += (digit & 31) * factor;
        if (digit < 32) return value;
        factor *= 32;
      }
    }
    const values = [];
    let [last, slope, difference] = [0, 0, 0];
    while (at < digits.length) {
      const next = token();
      if (next === 0) {
        values.push(NaN);
        continue;
      }
      let times = 1;
      if (next === 1) times = token();
      else difference = next % 2 === 0 ? (next - 2) / 2 : -(next - 1) / 2;
      for (; times > 0; times--) {
        slope = order === 1 ? difference : slope + difference;
        last += slope;
        values.push(offset + last * scale);
      }
    }
    return Float64Array.from(values);
  }

  const all = (selector) => [...document.querySelectorAll(selector)];

  function drawCharts(data) {
    const runs = data.runs.map((run) => {
      const columns = [];
      const column = (id) => (columns[id] ??= decode(run.columns[id]));
      return { time: decode(run.time), column };
    });
    const ends = runs.map(({ time }) => time[time.length - 1]);
    const group = LashloopCharts.group(Math.min(...runs.map(({ time }) => time[0])), Math.max(...ends));
    for (const place of all("[data-chart]")) {
      const chart = data.charts[Number(place.dataset.chart)];
      const series = chart.series.map((it) => {
        const run = runs[it.run];
        const y = run.column(it.y);
        const t = it.t === undefined ? run.time : run.column(it.t);
        const columns = it.x === undefined ? { x: run.time, y } : { t, x: run.column(it.x), y };
        return { ...columns, name: it.name, style: it.style, isHeld: it.isHeld, isDashed: it.isDashed };
      });
      place.replaceChildren();
      LashloopCharts.chart(place, { ...chart, group, series });
    }
    return group;
  }

  function connectControls(group) {
    const controls = document.querySelector(".controls");
    if (!controls) return;
    controls.hidden = false;
    const edges = all("[data-edge]");
    const time = controls.querySelector(".cursor-time");
    const decimals = () => Math.min(6, Math.max(3, Math.ceil(-Math.log10((group.view[1] - group.view[0]) / 1000))));
    group.listen(() => {
      edges.forEach((edge, index) => {
        if (edge !== document.activeElement) edge.value = group.view[index].toFixed(decimals());
      });
      time.textContent = group.cursor === null ? "" : `cursor ${group.cursor.toFixed(decimals())} s`;
    });
    edges.forEach((edge, index) => edge.addEventListener("change", () => {
      const value = Number(edge.value.replace(",", "."));
      const view = [...group.view];
      view[index] = value;
      if (edge.value.trim() !== "" && view[0] < view[1]) group.setView(...view);
      edge.blur();
      group.redraw();
    }));
    const actions = { in: () => group.zoom(0.5, group.cursor), out: () => group.zoom(2, group.cursor), reset: group.reset };
    for (const button of all("[data-do]")) button.addEventListener("click", actions[button.dataset.do]);
    for (const jump of all(".jump")) {
      jump.addEventListener("click", () => {
        const at = Number(jump.dataset.time);
        const half = Math.min(0.05, (group.extent[1] - group.extent[0]) / 2);
        group.setView(at - half, at + half);
        group.setCursor(at);
        document.querySelector("#plots").scrollIntoView();
      });
    }
    group.redraw();
  }

  function connectTheme() {
    const button = document.querySelector(".theme");
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const isDark = () => (document.documentElement.dataset.theme || (dark.matches ? "dark" : "light")) === "dark";
    const name = () => (button.textContent = isDark() ? "Light" : "Dark");
    button.hidden = false;
    button.setAttribute("aria-label", "Switch between light and dark");
    button.addEventListener("click", () => {
      document.documentElement.dataset.theme = isDark() ? "light" : "dark";
      name();
    });
    dark.addEventListener("change", name);
    name();
  }

  function connectCopy() {
    for (const button of all("[data-copy]")) {
      button.addEventListener("click", async () => {
        try {
          await navigator.clipboard.writeText(button.dataset.copy);
          button.textContent = "Copied";
        } catch {
          getSelection().selectAllChildren(button.previousElementSibling);
          button.textContent = "Selected";
        }
      });
    }
  }

  function connectFilters() {
    for (const group of all(".filters")) {
      group.hidden = false;
      for (const button of group.querySelectorAll("[data-filter]")) {
        button.addEventListener("click", () => {
          const isOn = button.getAttribute("aria-pressed") !== "true";
          button.setAttribute("aria-pressed", String(isOn));
          for (const row of all(`[data-tone="${button.dataset.filter}"]`)) row.hidden = !isOn;
        });
      }
    }
  }

  const data = JSON.parse(document.getElementById("data").textContent);
  connectTheme();
  connectCopy();
  connectFilters();
  if (data) connectControls(drawCharts(data));
  document.documentElement.dataset.ready = String(Math.round(performance.now()));
})();
