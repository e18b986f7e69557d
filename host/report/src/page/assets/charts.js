// Charts as SVG with linked time: zoom, pan, cursor and read-out by mouse, touch and keyboard.
//
//   const group = LashloopCharts.group(from, to);    a range of time and a cursor that charts have in common
//   const chart = LashloopCharts.chart(element, { group, title, unit, series: [...], shades: [...], marks: [...] });
//
// Series: { name, x, y } with ascending times x and values y of equal length; also `style` ("c0" to "c7", "reference",
// "limit"), `isDashed`, `isHeld` for steps. A chart with `axes: { x: { label, unit }, y: { label, unit } }` draws y over x
// instead; its series have the times as `t`, and the range of time selects what is drawn.
// Shades: { name, intervals: [from, to, from, to, ...] } over time. Marks: { x, label } are vertical lines.
// Bands: { name, from, to, low, high } are limits of the values over a part of the time; one of them may be null. Notes:
// { x, label } are texts at a time. `range: [low, high]`, or a function that returns it or null, fixes the vertical axis.
// The arrays of a series may be replaced at any time: group.extend(to) and group.redraw() show them.
"use strict";

const LashloopCharts = (() => {
  const S = LashloopScale;
  const LEFT = 58;
  const RIGHT = 12;
  const TOP = 8;
  const BOTTOM = 36;
  const SHORTEST_S = 1e-3;
  const PAPER_WIDTH = 380;
  let count = 0;

  function svg(name, attributes, parent) {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (parent) parent.append(node);
    return node;
  }

  function html(name, className, parent, text) {
    const node = document.createElement(name);
    if (className) node.className = className;
    if (text !== undefined) node.textContent = text;
    if (parent) parent.append(node);
    return node;
  }

  // A range has a length, also that of a single step.
  const extentOf = (from, to) => [from, Math.max(to, from + SHORTEST_S)];

  // A range of time and a cursor that charts have in common.
  function group(from, to) {
    const charts = [];
    const listeners = [];
    let isQueued = false;
    const self = {
      charts,
      extent: extentOf(from, to),
      view: extentOf(from, to),
      cursor: null,
      // Calls `listener(group)` after each change of range or cursor.
      listen: (listener) => listeners.push(listener),
      // Shows a range of time. It stays inside the extent and never shrinks below a millionth of it.
      setView(low, high) {
        if (!Number.isFinite(low) || !Number.isFinite(high)) return;
        const [start, end] = self.extent;
        const span = Math.min(Math.max(high - low, (end - start) * 1e-6, 1e-9), end - start);
        const first = Math.min(Math.max(low, start), end - span);
        self.view = [first, first + span];
        self.redraw();
      },
      reset: () => self.setView(...self.extent),
      // Zooms by `factor` about a time; below 1 the range shrinks.
      zoom(factor, about) {
        const [low, high] = self.view;
        const centre = about === null || about === undefined ? (low + high) / 2 : about;
        self.setView(centre - (centre - low) * factor, centre + (high - centre) * factor);
      },
      pan: (shift) => self.setView(self.view[0] + shift, self.view[1] + shift),
      // Puts the cursor at a time; null removes it.
      setCursor(time) {
        self.cursor = time;
        charts.forEach((chart) => chart.drawCursor());
        listeners.forEach((listener) => listener(self));
      },
      // Lengthens the extent. A range that ends with the old extent follows it.
      extend(end) {
        const [start, old] = self.extent;
        self.extent = extentOf(start, end);
        const [low, high] = self.view;
        if (low === start && high === old) self.view = [...self.extent];
        else if (high === old) self.view = [low + end - old, end];
      },
      // Draws all visible charts with the next frame.
      redraw() {
        charts.forEach((chart) => chart.invalidate());
        if (isQueued) return;
        isQueued = true;
        requestAnimationFrame(() => {
          isQueued = false;
          charts.forEach((chart) => chart.drawIfVisible());
          listeners.forEach((listener) => listener(self));
        });
      },
    };
    addEventListener("beforeprint", () => charts.forEach((chart) => chart.drawForPaper()));
    addEventListener("afterprint", () => charts.forEach((chart) => chart.measure()));
    return self;
  }

  function chart(host, options) {
    const { group, series, axes = null, shades = [], marks = [], bands = [], notes = [], range = null, unit = "" } = options;
    const id = `chart-${++count}`;
    let [width, height, isDirty, isVisible] = [0, 0, true, true];
    let [xRange, yRange] = [[0, 1], [0, 1]];

    host.classList.add("chart");
    const head = html("div", "chart-head", host);
    const title = html("h3", "", head, options.title);
    title.id = `${id}-title`;
    const axisText = axes ? `${axes.y.label} over ${axes.x.label}` : unit;
    const axisNode = html("span", "chart-unit", head, axisText);
    const legend = html("div", "legend", host);
    const plot = svg("svg", { class: "plot", tabindex: "0", role: "group", "aria-labelledby": title.id });
    plot.setAttribute("aria-describedby", "chart-keys");
    host.append(plot);
    const clip = svg("rect", {}, svg("clipPath", { id: `${id}-clip` }, svg("defs", {}, plot)));
    const layer = (className, isClipped) =>
      svg("g", isClipped ? { class: className, "clip-path": `url(#${id}-clip)` } : { class: className }, plot);
    const [shadeLayer, gridLayer, bandLayer, markLayer, curveLayer, noteLayer] = [
      layer("shades", true), layer("grid", false), layer("bands", true), layer("marks", true), layer("curves", true), layer("notes", true),
    ];
    const [cursorLayer, selection] = [layer("cursor", true), svg("rect", { class: "selection" }, plot)];
    const cursorLine = axes ? null : svg("line", { class: "cursor-line", y1: TOP }, cursorLayer);
    const live = html("div", "visually-hidden", host);
    live.setAttribute("aria-live", "polite");

    const curves = series.map((it, index) => {
      const style = it.style || `c${index % 8}`;
      const className = `curve ${style}${it.isDashed ? " dashed" : ""}`;
      const key = html("button", `key ${style}`, legend);
      key.type = "button";
      key.setAttribute("aria-pressed", "true");
      const line = svg("svg", { class: "swatch", viewBox: "0 0 22 8", "aria-hidden": "true" }, key);
      svg("path", { class: className, d: "M1 4H21" }, line);
      html("span", "key-name", key, it.name);
      const value = html("output", "key-value", key);
      const curve = {
        isShown: true, it, key, value,
        path: svg("path", { class: className }, curveLayer),
        dot: svg("circle", { class: `dot ${style}`, r: 3.5 }, cursorLayer),
      };
      key.addEventListener("click", () => {
        curve.isShown = !curve.isShown;
        key.setAttribute("aria-pressed", String(curve.isShown));
        self.draw();
      });
      return curve;
    });
    function explain(name, shape, attributes) {
      const key = html("span", "key", legend);
      svg(shape, attributes, svg("svg", { class: "swatch", viewBox: "0 0 22 8", "aria-hidden": "true" }, key));
      html("span", "key-name", key, name);
    }
    for (const shade of shades) explain(shade.name, "rect", { class: "shade", width: 22, height: 8 });
    const boundClass = ({ isExpected }) => (isExpected ? "bound expected" : "bound");
    for (const [name, band] of new Map(bands.map((it) => [it.name, it]))) {
      explain(name, "path", { class: boundClass(band), d: "M1 1H21M1 7H21" });
    }
    if (marks.length) explain("injected fault", "path", { class: "mark", d: "M11 -3V11" });

    const plotWidth = () => Math.max(width - LEFT - RIGHT, 1);
    const plotHeight = () => Math.max(height - TOP - BOTTOM, 1);
    const toX = (value) => LEFT + ((value - xRange[0]) / (xRange[1] - xRange[0])) * plotWidth();
    const toY = (value) => TOP + plotHeight() - ((value - yRange[0]) / (yRange[1] - yRange[0])) * plotHeight();

    // Indices of a series inside the range of time, with one more on either side.
    function shownRows(it) {
      const times = axes ? it.t : it.x;
      const first = S.lowerBound(times, group.view[0]);
      let end = S.lowerBound(times, group.view[1]);
      if (axes) return [first, Math.min(end + 1, times.length)];
      end = Math.min(end + 2, times.length);
      return [Math.max(first - 1, 0), end];
    }

    function rangeOf(name) {
      let sum = null;
      for (const { it, isShown } of curves) {
        if (!isShown) continue;
        const one = S.range(it[name], ...shownRows(it));
        if (one) sum = sum ? [Math.min(sum[0], one[0]), Math.max(sum[1], one[1])] : one;
      }
      return S.padded(sum || [0, 1]);
    }

    // The vertical range: as fixed, else that of the curves, and of limits that are near.
    function heightRange() {
      const fixed = typeof range === "function" ? range() : range;
      if (fixed) return fixed;
      let [low, high] = rangeOf("y");
      const near = (high - low) / 2;
      const shown = bands.filter((it) => it.from < group.view[1] && it.to > group.view[0]);
      for (const edge of shown.flatMap((it) => [it.low, it.high])) {
        if (edge === null || edge < low - near || edge > high + near) continue;
        const room = (high - low) * 0.04;
        [low, high] = [Math.min(low, edge - room), Math.max(high, edge + room)];
      }
      return [low, high];
    }

    function drawAxis(low, high, isX) {
      const most = isX ? Math.max(3, Math.floor(plotWidth() / 70)) : Math.max(2, Math.floor(plotHeight() / 36));
      const found = S.ticks(low, high, most);
      const { text, factor } = S.labels(found);
      found.values.forEach((value, index) => {
        const at = isX ? toX(value) : toY(value);
        const [x2, y2] = isX ? [at, TOP + plotHeight()] : [LEFT + plotWidth(), at];
        svg("line", { x1: isX ? at : LEFT, y1: isX ? TOP : at, x2, y2 }, gridLayer);
        const place = isX
          ? { x: at, y: TOP + plotHeight() + 16, "text-anchor": "middle" }
          : { x: LEFT - 8, y: at + 4, "text-anchor": "end" };
        svg("text", place, gridLayer).textContent = text[index];
      });
      return factor ? `10${superscript(factor)} ` : "";
    }

    function draw() {
      if (!width) return;
      isDirty = false;
      xRange = axes ? rangeOf("x") : group.view;
      yRange = axes ? rangeOf("y") : heightRange();
      const box = { x: LEFT, y: TOP, width: plotWidth(), height: plotHeight() };
      for (const [key, value] of Object.entries(box)) clip.setAttribute(key, value);
      gridLayer.replaceChildren();
      const factorX = drawAxis(...xRange, true);
      const factorY = drawAxis(...yRange, false);
      svg("rect", { class: "frame", ...box }, gridLayer);
      const [xName, xUnit] = axes ? [axes.x.label, axes.x.unit] : ["time", "s"];
      const xText = `${xName}${xUnit ? ` in ${factorX}${xUnit}` : ""}`;
      const xPlace = { class: "axis-name", x: LEFT + plotWidth(), y: height - 4, "text-anchor": "end" };
      svg("text", xPlace, gridLayer).textContent = xText;
      const yUnit = `${factorY}${axes ? axes.y.unit : unit}`.trim();
      axisNode.textContent = axes ? `${axes.y.label} in ${yUnit} over ${axes.x.label}` : yUnit;
      shadeLayer.replaceChildren();
      for (const { intervals } of shades) {
        svg("path", { class: "shade", d: shadePath(intervals) }, shadeLayer);
      }
      bandLayer.replaceChildren();
      for (const band of bands) {
        const { from, to, low, high } = band;
        const [x1, x2] = [toX(Math.max(from, group.view[0])), toX(Math.min(to, group.view[1]))];
        if (x2 <= x1) continue;
        const [top, bottom] = [high, low].map((edge) => (edge === null ? null : toY(edge)));
        if (top !== null && bottom !== null) {
          svg("rect", { class: "band", x: x1, width: x2 - x1, y: top, height: Math.max(bottom - top, 0) }, bandLayer);
        }
        for (const y of [top, bottom]) if (y !== null) svg("path", { class: boundClass(band), d: `M${x1} ${y}H${x2}` }, bandLayer);
      }
      noteLayer.replaceChildren();
      notes.forEach(({ x, label }, index) => {
        if (x < group.view[0] || x > group.view[1]) return;
        const at = toX(x);
        svg("line", { class: "note-line", x1: at, x2: at, y1: TOP, y2: TOP + plotHeight() }, noteLayer);
        const isLeft = at > LEFT + plotWidth() * 0.7;
        const place = { class: "note-text", x: at + (isLeft ? -5 : 5), y: TOP + 13 + 15 * index, "text-anchor": isLeft ? "end" : "start" };
        svg("text", place, noteLayer).textContent = label;
      });
      markLayer.replaceChildren();
      for (const { x, label } of marks) {
        if (x < group.view[0] || x > group.view[1] || axes) continue;
        const line = { class: "mark", x1: toX(x), x2: toX(x), y1: TOP, y2: TOP + plotHeight() };
        svg("title", {}, svg("line", line, markLayer)).textContent = label;
      }
      for (const { it, isShown, path } of curves) {
        const rows = shownRows(it);
        const isDrawn = isShown && rows[1] > rows[0];
        const line = () => (axes ? S.trail(it.x, it.y, ...rows, toX, toY) : S.path(it.x, it.y, ...rows, toX, toY, it.isHeld));
        path.setAttribute("d", isDrawn ? line() : "");
      }
      drawCursor();
    }

    // Intervals closer than half a pixel become one.
    function shadePath(intervals) {
      const parts = [];
      let [open, close] = [NaN, NaN];
      const flush = () => {
        if (close > open) parts.push(`M${open.toFixed(1)} ${TOP}V${TOP + plotHeight()}H${close.toFixed(1)}V${TOP}Z`);
      };
      for (let i = 0; i < intervals.length; i += 2) {
        if (intervals[i + 1] < group.view[0] || intervals[i] > group.view[1]) continue;
        const from = Math.max(toX(intervals[i]), LEFT);
        const to = Math.min(toX(intervals[i + 1]), LEFT + plotWidth());
        if (from <= close + 0.5) {
          close = to;
          continue;
        }
        flush();
        [open, close] = [from, to];
      }
      flush();
      return parts.join("");
    }

    function drawCursor() {
      const time = group.cursor;
      const isInside = time !== null && time >= group.view[0] && time <= group.view[1];
      if (cursorLine) {
        cursorLine.classList.toggle("hidden", !isInside);
        const x = isInside ? toX(time) : 0;
        cursorLine.setAttribute("x1", x);
        cursorLine.setAttribute("x2", x);
        cursorLine.setAttribute("y2", TOP + plotHeight());
      }
      for (const { it, isShown, dot, value } of curves) {
        const at = time === null ? -1 : S.nearest(axes ? it.t : it.x, time);
        const [x, y] = at < 0 ? [NaN, NaN] : [it.x[at], it.y[at]];
        const isSeen = isInside && isShown && Number.isFinite(y) && Number.isFinite(x);
        dot.classList.toggle("hidden", !isSeen);
        if (isSeen) {
          dot.setAttribute("cx", toX(x));
          dot.setAttribute("cy", toY(y));
        }
        const span = (range) => range[1] - range[0];
        const text = axes ? `${S.readOut(x, span(xRange))}; ${S.readOut(y, span(yRange))}` : S.readOut(y, span(yRange));
        value.textContent = at < 0 ? "" : text;
      }
    }

    // The values at the cursor as text, for a screen reader.
    function announce() {
      const values = curves.filter((it) => it.isShown).map(({ it, value }) => `${it.name} ${value.textContent}`);
      const time = group.cursor === null ? "" : `${S.readOut(group.cursor, group.view[1] - group.view[0])} s: `;
      live.textContent = `${time}${values.join(", ")} ${unit}`;
    }

    // The time at a place of the pointer. Over a trail it is that of the nearest point.
    function timeAt(clientX, clientY) {
      const box = plot.getBoundingClientRect();
      const x = ((clientX - box.left) / box.width) * width;
      if (!axes) {
        const fraction = (x - LEFT) / plotWidth();
        return group.view[0] + Math.min(Math.max(fraction, 0), 1) * (group.view[1] - group.view[0]);
      }
      const y = ((clientY - box.top) / box.height) * height;
      let [best, time] = [Infinity, group.cursor];
      for (const { it, isShown } of curves) {
        if (!isShown) continue;
        const [from, to] = shownRows(it);
        for (let i = from; i < to; i++) {
          const distance = (toX(it.x[i]) - x) ** 2 + (toY(it.y[i]) - y) ** 2;
          if (distance < best) [best, time] = [distance, it.t[i]];
        }
      }
      return time;
    }

    // Times of the samples of the first shown series, on which the keys move the cursor.
    function sampleTimes() {
      const shown = curves.find((it) => it.isShown);
      return shown ? (axes ? shown.it.t : shown.it.x) : [];
    }

    // Shades a part of the range while it is being selected; null ends that.
    function select(from, to) {
      const isOn = from !== null;
      selection.classList.toggle("active", isOn);
      if (!isOn) return;
      const [a, b] = [toX(Math.min(from, to)), toX(Math.max(from, to))];
      for (const [key, value] of Object.entries({ x: a, y: TOP, width: b - a, height: plotHeight() })) {
        selection.setAttribute(key, value);
      }
    }

    const self = {
      id, host, plot, group, isTrail: axes !== null, announce, draw, drawCursor, sampleTimes, select, timeAt,
      series,
      pixels: plotWidth,
      invalidate: () => (isDirty = true),
      drawIfVisible: () => isDirty && isVisible && draw(),
    };
    group.charts.push(self);
    LashloopGestures.attach(self);
    const isTall = options.isTall || axes;
    function resize(newWidth, newHeight) {
      [width, height] = [newWidth, Math.round(newHeight)];
      plot.setAttribute("viewBox", `0 0 ${width} ${height}`);
      draw();
    }
    self.measure = () => {
      const box = host.getBoundingClientRect();
      if (matchMedia("print").matches || !box.width) return;
      const style = getComputedStyle(host);
      const inner = Math.floor(box.width - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight));
      resize(inner, isTall ? Math.min(340, Math.max(260, inner * 0.6)) : Math.min(250, Math.max(190, inner * 0.42)));
    };
    // A page of paper scales the drawing to half its width, 88 mm: labels of 12 px get 7.9 pt.
    self.drawForPaper = () => width && resize(PAPER_WIDTH, PAPER_WIDTH * (isTall ? 0.66 : 0.5));
    new ResizeObserver(self.measure).observe(host);
    new IntersectionObserver(([entry]) => {
      isVisible = entry.isIntersecting;
      self.drawIfVisible();
    }, { rootMargin: "200px" }).observe(host);
    return self;
  }

  function superscript(number) {
    const digits = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";
    return String(number).replace(/./g, (it) => (it === "-" ? "\u207b" : digits[Number(it)]));
  }

  return { chart, group };
})();
