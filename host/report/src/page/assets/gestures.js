// Mouse, touch and keyboard on a chart.
//
// Mouse: move for the cursor, drag to zoom, Shift and drag to pan, Ctrl and wheel to zoom, double click for the whole range.
// Touch: one finger moves the cursor, two zoom and pan. Keys: see KEYS; LashloopGestures.KEYS_TEXT describes them.
"use strict";

const LashloopGestures = (() => {
  const KEYS_TEXT =
    "Keys: left and right arrow move the cursor, with Shift they pan; plus and minus zoom; Home and End go to the ends; " +
    "Escape shows the whole range.";
  const DRAG_PX = 5;

  function attach(chart) {
    const { plot, group } = chart;
    const fingers = new Map();
    let drag = null;
    let pinch = null;

    const perPixel = () => (group.view[1] - group.view[0]) / chart.pixels();

    function startPinch() {
      const [a, b] = [...fingers.values()];
      pinch = { view: group.view, gap: Math.max(Math.abs(a.x - b.x), 1), middle: (a.x + b.x) / 2 };
      pinch.about = chart.timeAt(pinch.middle, a.y);
      chart.select(null);
      drag = null;
    }

    function movePinch() {
      const [a, b] = [...fingers.values()];
      const factor = pinch.gap / Math.max(Math.abs(a.x - b.x), 1);
      const [low, high] = pinch.view;
      const shift = ((pinch.middle - (a.x + b.x) / 2) * (high - low) * factor) / chart.pixels();
      const { about } = pinch;
      group.setView(about - (about - low) * factor + shift, about + (high - about) * factor + shift);
    }

    plot.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "mouse" && event.button !== 0) return;
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (fingers.size === 2) return startPinch();
      const time = chart.timeAt(event.clientX, event.clientY);
      if (event.pointerType === "touch") return group.setCursor(time);
      plot.setPointerCapture(event.pointerId);
      drag = { x: event.clientX, time, view: group.view, isPan: event.shiftKey, isFar: false };
    });

    plot.addEventListener("pointermove", (event) => {
      if (fingers.has(event.pointerId)) fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (pinch) return fingers.size === 2 && movePinch();
      const time = chart.timeAt(event.clientX, event.clientY);
      group.setCursor(time);
      if (!drag) return;
      drag.isFar ||= Math.abs(event.clientX - drag.x) > DRAG_PX;
      if (!drag.isFar || chart.isTrail) return;
      if (drag.isPan) {
        const shift = (drag.x - event.clientX) * ((drag.view[1] - drag.view[0]) / chart.pixels());
        group.setView(drag.view[0] + shift, drag.view[1] + shift);
      } else {
        chart.select(drag.time, time);
      }
    });

    function end(event) {
      fingers.delete(event.pointerId);
      if (fingers.size < 2) pinch = null;
      chart.select(null);
      const done = drag;
      drag = null;
      if (event.type !== "pointerup" || !done || !done.isFar || done.isPan || chart.isTrail) return;
      const time = chart.timeAt(event.clientX, event.clientY);
      group.setView(Math.min(done.time, time), Math.max(done.time, time));
    }
    plot.addEventListener("pointerup", end);
    plot.addEventListener("pointercancel", end);
    plot.addEventListener("pointerleave", (event) => {
      if (event.pointerType === "mouse" && !drag && document.activeElement !== plot) group.setCursor(null);
    });
    plot.addEventListener("dblclick", () => group.reset());

    plot.addEventListener("wheel", (event) => {
      // A plain wheel scrolls the page.
      if (event.ctrlKey || event.metaKey) {
        event.preventDefault();
        group.zoom(Math.exp(event.deltaY * 0.002), chart.timeAt(event.clientX, event.clientY));
      } else if (event.deltaX !== 0 || event.shiftKey) {
        event.preventDefault();
        group.pan((event.deltaX || event.deltaY) * perPixel());
      }
    }, { passive: false });

    // The sample at least a pixel, else one sample, away from the cursor.
    function step(direction, pixels) {
      const times = chart.sampleTimes();
      if (!times.length) return;
      const [low, high] = group.view;
      const now = group.cursor === null || group.cursor < low || group.cursor > high ? (low + high) / 2 : group.cursor;
      const at = LashloopScale.nearest(times, now);
      const far = LashloopScale.nearest(times, now + direction * pixels * perPixel());
      const next = direction * (far - at) > 0 ? far : at + direction;
      moveTo(times[Math.min(Math.max(next, 0), times.length - 1)]);
    }

    // Moves the cursor, and the range if the cursor would leave it.
    function moveTo(time) {
      const [low, high] = group.view;
      if (time < low) group.pan(time - low);
      if (time > high) group.pan(time - high);
      group.setCursor(time);
      chart.announce();
    }

    const about = () => group.cursor;
    const KEYS = {
      ArrowLeft: (isShift) => (isShift ? group.pan(-40 * perPixel()) : step(-1, 1)),
      ArrowRight: (isShift) => (isShift ? group.pan(40 * perPixel()) : step(1, 1)),
      PageUp: () => step(-1, 40),
      PageDown: () => step(1, 40),
      Home: () => moveTo(group.extent[0]),
      End: () => moveTo(group.extent[1]),
      "+": () => group.zoom(0.5, about()),
      "=": () => group.zoom(0.5, about()),
      "-": () => group.zoom(2, about()),
      0: () => group.reset(),
      Escape: () => group.reset(),
    };
    plot.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !Object.hasOwn(KEYS, event.key)) return;
      event.preventDefault();
      KEYS[event.key](event.shiftKey);
    });
    plot.addEventListener("blur", () => group.setCursor(null));
  }

  return { attach, KEYS_TEXT };
})();
