// Maps: cells in colours, with a colour bar, values under the pointer, and sections along lines.

const MAP = { left: 74, top: 12, most: [470, 400], bar: 130, below: 62 };
// Where there is less room than this, pixels, the colour bar lies below the map.
const SLIM = 480;
const SLIM_MAP = { left: 62, top: 12, right: 24, below: 126 };
// A map longer than this is squeezed.
const LONGEST = 5;
// Pixels along each side of the picture of a map of rings.
const ROUND_PIXELS = 480;
// Places along a section.
const SECTION_STEPS = 600;

function drawMap(figure, data) {
  const { controls, body, readout } = layOut(figure, "map", "point for values, drag for a section; arrow keys move, Enter cuts along the row");
  const section = make("div", { class: "plot section" });
  const sectionReadout = make("output", { class: "readout" });
  const row = make("div", { class: "plot-row" });
  figure.insertBefore(row, readout);
  row.append(body, section);
  section.hidden = true;
  figure.append(sectionReadout);
  if (data.remark) controls.append(make("span", { class: "hint" }, data.remark));
  const geometry = geometryOf(data);
  const map = { data, geometry, line: firstLine(data, geometry), cell: -1 };
  let [scale, shown] = ["linear", "values"];
  const cut = () => {
    if (!map.line) return;
    const size = fitted(NARROW, section.clientWidth || NARROW.width);
    section.replaceChildren(...chartOf(sectionOf(map), scale, sectionReadout, size));
  };
  const again = drawToFit(row, (width) => {
    // What stands beside the map takes its room before the map is measured.
    section.hidden = !map.line;
    const svg = mapDrawing(map, scale, shown, Math.min(width, body.clientWidth));
    body.replaceChildren(svg);
    followMap(svg, map, readout, cut);
    cut();
  });
  scaleSwitch(controls, data.axes.bars, (wanted) => { scale = wanted; again(); });
  if (data.colours) stateSwitch(controls, "true colour", (isOn) => { shown = isOn ? "colours" : "values"; again(); });
  if (data.values.length > 1) touchSwitch(controls, body, "draw a section");
}

// Along the middle of the longer side; a map of all directions has no middle worth a cut.
function firstLine(data, { x, y, ratio }) {
  if (data.geometry === "directions" || data.values.length < 2) return null;
  const middle = ([from, to]) => (from + to) / 2;
  return ratio >= 1 ? [[x[0], middle(y)], [x[1], middle(y)]] : [[middle(x), y[0]], [middle(x), y[1]]];
}

// Where cells are: which cell a place of the plot belongs to, and the ranges of its axes.
function geometryOf(data) {
  const { x, y, axes } = data;
  const columns = x.length - 1;
  const ranges = { x: [axes.x.from, axes.x.to], y: [axes.y.from, axes.y.to] };
  if (data.geometry === "polar") {
    const cell = (a, b) => {
      const ring = binOf(y, Math.hypot(a, b));
      const sector = binOf(x, ((Math.atan2(b, a) * 180) / Math.PI + 360) % 360);
      return ring < 0 || sector < 0 ? -1 : ring * columns + sector;
    };
    return { ...ranges, cell, ratio: 1, pixels: [ROUND_PIXELS, ROUND_PIXELS] };
  }
  const cell = (a, b) => {
    const [column, row] = [binOf(x, a), binOf(y, b)];
    return column < 0 || row < 0 ? -1 : row * columns + column;
  };
  const size = ({ from, to, scale }) => SCALES[scale].to(to) - SCALES[scale].to(from);
  const ratio = data.geometry === "directions" ? 1.6 : size(axes.x) / size(axes.y);
  return { ...ranges, cell, ratio, pixels: [columns, y.length - 1] };
}

// The bin of a value between edges; -1 outside.
function binOf(edges, value) {
  if (value < edges[0] || value > edges.at(-1)) return -1;
  let [low, high] = [0, edges.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (edges[middle] <= value) low = middle;
    else high = middle;
  }
  return low;
}

function mapColour(share, palette) {
  const colours = pageData.palettes[palette];
  const at = Math.min(Math.max(share, 0), 1) * (colours.length - 1);
  const low = Math.min(Math.floor(at), colours.length - 2);
  return colours[low].map((part, i) => Math.round(part + (at - low) * (colours[low + 1][i] - part)));
}

function mapDrawing(map, scale, shown, room) {
  const { data, geometry } = map;
  const ratio = Math.min(Math.max(geometry.ratio, 1 / LONGEST), LONGEST);
  const isSlim = room < SLIM;
  const beside = isSlim ? SLIM_MAP.left + SLIM_MAP.right : MAP.left + MAP.bar;
  const width = Math.min(MAP.most[0], MAP.most[1] * ratio, room - beside);
  const height = width / ratio;
  const { left, top, below } = isSlim ? SLIM_MAP : MAP;
  const svg = drawing(isSlim ? room : beside + width, top + height + below, data.title);
  const [x, y, colours] = [data.axes.x, data.axes.y, data.axes.bars[scale]].map(axisOf);
  const area = { left, top, width, height };
  const colourOf = shown === "colours" ? (cell) => data.colours[cell] : (cell) => mapColour(colours.share(data.values[cell]), colours.palette);
  const picture = mapPicture(map, [x, y], colourOf);
  svg.append(make("image", { x: area.left, y: area.top, width, height, preserveAspectRatio: "none", href: picture }));
  Object.assign(map, { x, y, area, place: drawAxes(svg, area, x, y, "plain") });
  const aside = isSlim ? { x: left, y: top + height + 68 } : { x: left + width + 24, y: top + 12 };
  if (shown === "colours") svg.append(make("text", { ...aside, class: "soft" }, "sRGB, D65"));
  else if (isSlim) drawColourBarBelow(svg, { left, top: top + height + 68, width: room - left - SLIM_MAP.right }, colours);
  else drawColourBar(svg, area, colours);
  if (ratio !== geometry.ratio && data.geometry !== "directions") {
    const y = area.top + height + (isSlim ? below - 4 : 56);
    svg.append(make("text", { x: area.left, y, class: "soft" }, "axes are not to the same scale"));
  }
  return svg;
}

function mapPicture({ data, geometry }, [x, y], colourOf) {
  const [width, height] = geometry.pixels;
  const canvas = make("canvas", { width, height });
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  for (let row = 0; row < height; row += 1) {
    for (let column = 0; column < width; column += 1) {
      const cell = geometry.cell(x.value((column + 0.5) / width), y.value(1 - (row + 0.5) / height));
      const value = cell < 0 ? null : data.values[cell];
      if (value === null || value === undefined) continue;
      image.data.set([...colourOf(cell), 255], 4 * (row * width + column));
    }
  }
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

// Steps of colour of a bar.
const BAR_STEPS = 64;

function drawColourBar(svg, area, axis) {
  const left = area.left + area.width + 24;
  const bottom = area.top + area.height;
  for (let step = 0; step < BAR_STEPS; step += 1) {
    const colour = mapColour((step + 0.5) / BAR_STEPS, axis.palette).join(" ");
    const top = bottom - (area.height * (step + 1)) / BAR_STEPS;
    svg.append(make("rect", { x: left, y: around(top), width: 16, height: around(area.height / BAR_STEPS + 0.6), style: `fill: rgb(${colour})` }));
  }
  drawTips(svg, axis, (end) => (end === 1 ? `M${left} ${area.top}h16l-8 -10z` : `M${left} ${bottom}h16l-8 10z`));
  const row = (value) => around(bottom - axis.share(value) * area.height);
  for (const value of axis.minor) svg.append(make("path", { d: `M${left + 16} ${row(value)}h2`, class: "axis" }));
  for (const [value, words] of axis.ticks) {
    svg.append(make("path", { d: `M${left + 16} ${row(value)}h4`, class: "axis" }));
    svg.append(make("text", { x: left + 24, y: row(value) + 4 }, words));
  }
  svg.append(make("text", { x: left, y: bottom + 24 }, axis.label));
}

// Tips of a bar at the ends beyond which there are values.
function drawTips(svg, axis, tip) {
  axis.beyond.forEach((isBeyond, end) => {
    if (!isBeyond) return;
    svg.append(make("path", { d: tip(end), class: "axis", style: `fill: rgb(${mapColour(end, axis.palette).join(" ")})` }));
  });
}

// The bar on its side, where there is no room beside the map; its label above it.
function drawColourBarBelow(svg, { left, top, width }, axis) {
  for (let step = 0; step < BAR_STEPS; step += 1) {
    const colour = mapColour((step + 0.5) / BAR_STEPS, axis.palette).join(" ");
    const at = around(left + (width * step) / BAR_STEPS);
    svg.append(make("rect", { x: at, y: top, width: around(width / BAR_STEPS + 0.6), height: 14, style: `fill: rgb(${colour})` }));
  }
  drawTips(svg, axis, (end) => (end === 1 ? `M${left + width} ${top}v14l10 -7z` : `M${left} ${top}v14l-10 -7z`));
  const column = (value) => around(left + axis.share(value) * width);
  for (const value of axis.minor) svg.append(make("path", { d: `M${column(value)} ${top + 14}v2`, class: "axis" }));
  for (const [at, words] of withRoom(axis.ticks.map(([value, words]) => [column(value), words]))) {
    svg.append(make("path", { d: `M${at} ${top + 14}v4`, class: "axis" }));
    svg.append(make("text", { x: at, y: top + 31, "text-anchor": "middle" }, words));
  }
  svg.append(make("text", { x: left, y: top - 6 }, axis.label));
}

// What a cell is called, and what is in it.
function cellWords({ data }, cell) {
  const columns = data.x.length - 1;
  const [row, column] = [Math.floor(cell / columns), cell % columns];
  const middle = (edges, i) => formatValue((edges[i] + edges[i + 1]) / 2);
  const place = `${data.x_name} ${middle(data.x, column)} ${data.x_unit}, ${data.y_name} ${middle(data.y, row)} ${data.y_unit}`;
  const value = data.values[cell];
  if (value === null) return `${place}: outside the sensor`;
  const [u, v] = data.uv ? data.uv.map((own) => own[cell]) : [null, null];
  const withError = (of, place) => (data.uv_errors ? formatWithError(of, data.uv_errors[place][cell]) : formatValue(of));
  const colour = u === null ? "" : `, u' ${withError(u, 0)}, v' ${withError(v, 1)}`;
  return `${place}: ${quantity(value, data.errors[cell], data.biases?.[cell], data.unit)}${colour}`;
}

function followMap(svg, map, readout, cut) {
  const [back, cursor, line] = ["cursor-back", "cursor", "cursor"].map((name) => make("path", { class: name }));
  const lineBack = make("path", { class: "cursor-back" });
  svg.append(back, cursor, lineBack, line);
  const valuesAt = ([px, py]) => {
    const share = (at, from, size) => Math.min(Math.max((at - from) / size, 0), 1);
    return [map.x.value(share(px, map.area.left, map.area.width)), map.y.value(1 - share(py, map.area.top, map.area.height))];
  };
  const showCell = (cell) => {
    if (cell < 0) return;
    map.cell = cell;
    const outline = cellOutline(map, cell);
    back.setAttribute("d", outline);
    cursor.setAttribute("d", outline);
    readout.textContent = cellWords(map, cell);
  };
  const showLine = () => {
    if (!map.line) return;
    const path = map.line.map(([a, b]) => map.place(a, b).map(around).join(" ")).join("L");
    lineBack.setAttribute("d", `M${path}`);
    line.setAttribute("d", `M${path}`);
  };
  showLine();
  let start = null;
  svg.addEventListener("pointerdown", (event) => {
    const here = valuesAt(pointerAt(svg, event));
    showCell(map.geometry.cell(...here));
    if (!mayDrag(svg.parentElement, event)) return;
    start = here;
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    const here = valuesAt(pointerAt(svg, event));
    showCell(map.geometry.cell(...here));
    if (!start || (here[0] === start[0] && here[1] === start[1])) return;
    map.line = [start, here];
    showLine();
    cut();
  });
  for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, () => { start = null; });
  svg.addEventListener("keydown", (event) => moveByKey(event, map, showCell, () => { showLine(); cut(); }));
}

function moveByKey(event, map, showCell, cutHere) {
  const [columns, rows] = [map.data.x.length - 1, map.data.y.length - 1];
  const cell = Math.max(map.cell, 0);
  const [row, column] = [Math.floor(cell / columns), cell % columns];
  const moves = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 0], ArrowDown: [-1, 0] };
  if (moves[event.key]) {
    const [up, right] = moves[event.key];
    showCell(Math.min(Math.max(row + up, 0), rows - 1) * columns + Math.min(Math.max(column + right, 0), columns - 1));
  } else if (event.key === "Enter") {
    const height = map.data.geometry === "polar" ? 0 : (map.data.y[row] + map.data.y[row + 1]) / 2;
    map.line = [[map.geometry.x[0], height], [map.geometry.x[1], height]];
    cutHere();
  } else {
    return;
  }
  event.preventDefault();
}

function cellOutline({ data, place }, cell) {
  const columns = data.x.length - 1;
  const [row, column] = [Math.floor(cell / columns), cell % columns];
  const [a, b, c, d] = [data.x[column], data.x[column + 1], data.y[row], data.y[row + 1]];
  const corners = [];
  if (data.geometry === "polar") {
    const steps = Math.max(2, Math.ceil((b - a) / 6));
    const angles = Array.from({ length: steps + 1 }, (_, i) => ((a + ((b - a) * i) / steps) * Math.PI) / 180);
    const arc = (radius, along) => along.map((angle) => place(radius * Math.cos(angle), radius * Math.sin(angle)));
    corners.push(...arc(d, angles), ...arc(c, [...angles].reverse()));
  } else {
    corners.push(place(a, c), place(b, c), place(b, d), place(a, d));
  }
  return `M${corners.map((corner) => corner.map(around).join(" ")).join("L")}z`;
}

// The cells under a line as a chart: each at the middle of its part of the line.
function sectionOf(map) {
  const { data, geometry } = map;
  const [[ax, ay], [bx, by]] = map.line;
  const length = Math.hypot(bx - ax, by - ay);
  const series = { name: "", form: "line", errors: "band", colour: 0, dash: "none", x: [], y: [], error: [], bias: [] };
  let [last, since] = [-1, 0];
  const close = (until) => {
    if (last < 0 || data.values[last] === null) return;
    series.x.push(((since + until) / 2) * length);
    series.y.push(data.values[last]);
    series.error.push(data.errors[last]);
    series.bias.push(data.biases?.[last]);
  };
  for (let step = 0; step <= SECTION_STEPS; step += 1) {
    const share = step / SECTION_STEPS;
    const cell = geometry.cell(ax + share * (bx - ax), ay + share * (by - ay));
    if (cell === last) continue;
    close(share);
    [last, since] = [cell, share];
  }
  close(1);
  const unit = data.geometry === "polar" ? data.y_unit : data.x_unit;
  const at = (a, b) => `(${formatValue(a)}, ${formatValue(b)})`;
  const x = axisAlong(data.axes.along, length, `along the line from ${at(ax, ay)} to ${at(bx, by)} in ${unit}`);
  // Colours and heights say the same.
  const y = (bar) => ({ ...bar, label: `${data.quantity} in ${bar.label}` });
  const axes = Object.fromEntries(Object.entries(data.axes.bars).map(([scale, bar]) => [scale, { x, y: y(bar) }]));
  return { title: "section", unit: data.unit, x_name: x.label, series: [series], axes };
}
