// Ranges, ticks, numbers and thinning: functions of data alone.
"use strict";

const LashloopScale = (() => {
  // Index of the first element of an ascending array that is not below `value`.
  function lowerBound(values, value) {
    let low = 0;
    let high = values.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (values[middle] < value) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  // Index of the element of an ascending array that is nearest to `value`; -1 for none.
  function nearest(values, value) {
    const at = lowerBound(values, value);
    if (at === 0) return values.length ? 0 : -1;
    if (at === values.length) return at - 1;
    return value - values[at - 1] <= values[at] - value ? at - 1 : at;
  }

  // Smallest and largest finite number of values[from..to]; null for none.
  function range(values, from, to) {
    let low = Infinity;
    let high = -Infinity;
    for (let i = from; i < to; i++) {
      const value = values[i];
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return low <= high && Number.isFinite(low) && Number.isFinite(high) ? [low, high] : null;
  }

  // The range with a margin. A single value gets a range of its own magnitude.
  function padded([low, high], margin = 0.06) {
    const span = high - low;
    if (span > Math.max(Math.abs(low), Math.abs(high)) * 1e-12) {
      return [low - span * margin, high + span * margin];
    }
    const half = Math.abs(low) * 0.1 || 1;
    return [low - half, high + half];
  }

  // Multiples of 1, 2 or 5 times a power of ten inside the range, at most `most`.
  function ticks(low, high, most) {
    const rough = (high - low) / Math.max(most, 1);
    const power = Math.floor(Math.log10(rough));
    const mantissa = [1, 2, 5, 10].find((it) => it * 10 ** power >= rough * (1 - 1e-9)) || 10;
    const [m, exponent] = mantissa === 10 ? [1, power + 1] : [mantissa, power];
    // Dividing by a power of ten gives the double nearest to the decimal; multiplying by its inverse does not.
    const value = (n) => (exponent < 0 ? (n * m) / 10 ** -exponent : n * m * 10 ** exponent);
    const step = value(1);
    const first = Math.ceil(low / step - 1e-9);
    const last = Math.floor(high / step + 1e-9);
    const values = [];
    for (let n = first; n <= last; n++) values.push(value(n));
    return { values, exponent };
  }

  // Labels of ticks, and the power of ten that they leave out.
  function labels({ values, exponent }) {
    const largest = Math.max(...values.map(Math.abs), 0);
    const isPlain = largest < 1e5 && exponent >= -4;
    const factor = isPlain || largest === 0 ? 0 : Math.floor(Math.log10(largest));
    const decimals = Math.max(0, factor - exponent);
    const text = values.map((value) => minus((value / 10 ** factor).toFixed(Math.min(decimals, 20))));
    return { text, factor };
  }

  function minus(text) {
    return text.replace(/-/g, "\u2212");
  }

  // A value with decimals down to 1e-4 of the span that it is read in.
  function readOut(value, span) {
    if (!Number.isFinite(value)) return "\u2013";
    const scale = span > 0 ? span : Math.abs(value) || 1;
    const decimals = Math.ceil(-Math.log10(scale * 1e-4));
    if (Math.abs(value) >= 1e6 || decimals > 9) return minus(value.toExponential(4));
    return minus(value.toFixed(Math.max(0, decimals)));
  }

  const round = (number) => Math.round(number * 10) / 10;

  // Collects points as a path. A single point becomes a dash of 3 pixels: a path of one point draws nothing.
  function pen(isHeld) {
    const parts = [];
    let count = 0;
    const lift = () => {
      if (count === 1) parts.push("m-1.5 0h3");
      count = 0;
    };
    const to = (px, py) => {
      if (count === 0) parts.push("M", round(px), " ", round(py));
      else if (isHeld) parts.push("H", round(px), "V", round(py));
      else parts.push("L", round(px), " ", round(py));
      count += 1;
    };
    const path = () => {
      lift();
      return parts.join("");
    };
    return { isDown: () => count > 0, lift, path, to };
  }

  // Path of a curve over ascending x. Each column of a pixel keeps its first, smallest, largest and last value, so that no
  // peak is lost. A value that is not finite breaks the curve. `isHeld` draws steps.
  function path(x, y, from, to, toX, toY, isHeld) {
    const columns = Math.abs(toX(x[to - 1]) - toX(x[from])) + 1;
    if (!Number.isFinite(columns)) return "";
    const line = pen(isHeld);
    if (to - from <= 3 * columns) {
      for (let i = from; i < to; i++) {
        if (Number.isFinite(y[i])) line.to(toX(x[i]), toY(y[i]));
        else line.lift();
      }
      return line.path();
    }
    let i = from;
    while (i < to) {
      const column = Math.floor(toX(x[i]));
      const first = i;
      let low = -1;
      let high = -1;
      let last = -1;
      for (; i < to && Math.floor(toX(x[i])) === column; i++) {
        if (!Number.isFinite(y[i])) continue;
        if (low < 0 || y[i] < y[low]) low = i;
        if (high < 0 || y[i] > y[high]) high = i;
        last = i;
      }
      if (low < 0) {
        line.lift();
        continue;
      }
      if (Number.isFinite(y[first])) line.to(column, toY(y[first]));
      const [one, two] = low < high ? [low, high] : [high, low];
      line.to(column, toY(y[one]));
      if (two !== one) line.to(column, toY(y[two]));
      if (y[last] !== y[two]) line.to(column, toY(y[last]));
    }
    return line.path();
  }

  // Path of a curve over any x. A point less than half a pixel from the one before is omitted.
  function trail(x, y, from, to, toX, toY) {
    const line = pen(false);
    let [lastX, lastY] = [0, 0];
    for (let i = from; i < to; i++) {
      if (!Number.isFinite(x[i]) || !Number.isFinite(y[i])) {
        line.lift();
        continue;
      }
      const px = toX(x[i]);
      const py = toY(y[i]);
      if (line.isDown() && Math.abs(px - lastX) + Math.abs(py - lastY) < 0.5) continue;
      line.to(px, py);
      [lastX, lastY] = [px, py];
    }
    return line.path();
  }

  return { labels, lowerBound, minus, nearest, padded, path, range, readOut, ticks, trail };
})();
