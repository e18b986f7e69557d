// The page of a campaign: maps over two axes, and choices between blocks.
"use strict";

(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const CELL = [62, 30];
  const [LEFT, TOP, BOTTOM] = [66, 24, 44];

  function filled(it, attributes, children) {
    for (const [key, value] of Object.entries(attributes)) it.setAttribute(key, value);
    it.append(...children);
    return it;
  }
  const html = (name, attributes, ...children) => filled(document.createElement(name), attributes, children);
  const svg = (name, attributes, ...children) => filled(document.createElementNS(SVG, name), attributes, children);

  function label(x, y, text, anchor = "middle") {
    return svg("text", { x, y, "text-anchor": anchor }, text);
  }

  // A map of one variant; the first tick of the vertical axis is at the bottom.
  function draw(map, xAxis, yAxis, name) {
    const [columns, rows] = [xAxis.ticks.length, yAxis.ticks.length];
    const [width, height] = [LEFT + columns * CELL[0] + 8, TOP + rows * CELL[1] + BOTTOM];
    const x = (tick) => LEFT + (tick + 0.5) * CELL[0];
    const y = (tick) => TOP + (rows - tick - 0.5) * CELL[1];
    const drawing = svg("svg", { class: "map", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": name });
    drawing.style.maxWidth = `${width}px`;
    drawing.style.minWidth = `min(${width}px, 560px)`;
    const texts = [];
    map.cells.forEach((text, at) => {
      const [column, row] = [at % columns, Math.floor(at / columns)];
      const corner = { x: x(column) - CELL[0] / 2, y: y(row) - CELL[1] / 2 };
      const level = map.levels[at];
      drawing.append(svg("rect", { ...corner, width: CELL[0], height: CELL[1], class: `cell l${level}` }));
      const cell = label(x(column), y(row) + 4, text);
      cell.setAttribute("class", level === "n" ? "without" : "value");
      texts.push(cell);
    });
    const ends = map.lines;
    let path = "";
    for (let at = 0; at < ends.length; at += 4) {
      path += `M${x(ends[at])} ${y(ends[at + 1])}L${x(ends[at + 2])} ${y(ends[at + 3])}`;
    }
    drawing.append(svg("path", { class: "iso", d: path }), ...texts);
    xAxis.ticks.forEach((text, tick) => drawing.append(label(x(tick), height - BOTTOM + 16, text)));
    yAxis.ticks.forEach((text, tick) => drawing.append(label(LEFT - 6, y(tick) + 4, text, "end")));
    drawing.append(label((LEFT + width - 8) / 2, height - 8, xAxis.name));
    // Above its ticks: a name may be longer than the map is high.
    drawing.append(label(4, 14, yAxis.name, "start"));
    return drawing;
  }

  function select(name, options, change) {
    const it = html("select", { "data-map": name });
    const fill = (texts) => it.replaceChildren(...texts.map((text, at) => html("option", { value: at }, text)));
    fill(options);
    it.addEventListener("change", change);
    const whole = html("label", {}, `${name} `, it);
    whole.hidden = options.length < 2;
    return { it, whole, fill };
  }

  function maps(place, part, hasName) {
    const controls = html("p", { class: "choose" });
    const drawings = html("div", { class: "maps" });
    const measure = select("colour", part.measures.map(({ name }) => name), redraw);
    const pair = select("axes", part.pairs.map((it) => it.map((axis) => part.axes[axis].name).join(" \u00d7 ")), () => {
      slice.fill(part.slices[pair.it.value]);
      redraw();
    });
    const slice = select("further axes", part.slices[0], redraw);
    controls.append(measure.whole, pair.whole, slice.whole);
    if (hasName) place.append(html("h3", {}, `part ${part.name}`));
    place.append(controls, drawings);

    function redraw() {
      const { name, limits } = part.measures[measure.it.value];
      const [xAxis, yAxis] = part.pairs[pair.it.value].map((axis) => part.axes[axis]);
      const chosen = part.slices[pair.it.value][slice.it.value];
      drawings.replaceChildren(...part.variants.map((variant, at) => {
        const map = part.maps[measure.it.value][pair.it.value][slice.it.value][at];
        const text = [name, chosen, limits[at] && `limit ${limits[at]}`].filter(Boolean).join(" \u00b7 ");
        const caption = html("figcaption", {}, html("strong", {}, variant), text);
        const drawing = draw(map, xAxis, yAxis, `${variant}: ${text}`);
        return html("figure", {}, caption, html("div", { class: "scroll" }, drawing));
      }));
    }
    redraw();
  }

  for (const it of document.querySelectorAll("[data-choose]")) {
    const blocks = [...it.closest("section").querySelectorAll("[data-choice]")];
    const show = () => blocks.forEach((block) => (block.hidden = block.dataset.choice !== it.value));
    it.closest(".choose").hidden = false;
    it.addEventListener("change", show);
    show();
  }
  const place = document.querySelector(".map-place");
  if (place) {
    const parts = JSON.parse(document.getElementById("map-data").textContent);
    place.replaceChildren();
    for (const part of parts) maps(place, part, parts.length > 1);
  }
})();
