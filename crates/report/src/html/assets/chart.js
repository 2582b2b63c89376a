// Curves with error bars or bands, steps and dots, over one axis; values under the pointer.

// Largest sizes of a chart, and of a section beside its map.
const WIDE = { width: 760, height: 380 };
const NARROW = { width: 500, height: 340 };

function drawChart(figure, data) {
  const { controls, body, readout } = layOut(figure, "chart", "point at the plot for values; arrow keys step");
  let scale = "linear";
  const again = drawToFit(body, (width) => body.replaceChildren(...chartOf(data, scale, readout, fitted(WIDE, width))));
  scaleSwitch(controls, data.axes, (wanted) => { scale = wanted; again(); });
}

// A size within a width, and not much flatter than it was.
const fitted = (size, width) => ({ width: Math.min(size.width, width), height: Math.min(size.height, Math.max(0.8 * width, 240)) });

// The drawing of a chart and its legend, on axes of one of its scales.
function chartOf(data, scale, readout, { width, height }) {
  const svg = drawing(width, height, data.title);
  const [x, y] = [axisOf(data.axes[scale].x), axisOf(data.axes[scale].y)];
  const left = 34 + Math.max(34, ...y.ticks.map(([, words]) => widthOf(words)));
  const below = 50 + 15 * wrapped(x.label, width - 8).length;
  const area = { left, top: 12, width: width - left - 18, height: height - below };
  const place = drawAxes(svg, area, x, y, "grid");
  // Curves stay inside the frame; the values under the pointer tell what lies beyond it.
  const bottom = area.top + area.height;
  const at = (a, b) => { const [px, py] = place(a, b); return [around(px), around(Math.min(Math.max(py, area.top), bottom))]; };
  data.series.forEach((one) => drawSeries(svg, one, x, at));
  followChart(svg, data, { x, at, area }, readout);
  return [svg, legendOf(data.series)];
}

function drawSeries(svg, one, x, at) {
  const colour = seriesColour(one.colour);
  const known = one.x.map((_, i) => i).filter((i) => one.y[i] !== null && one.x[i] <= x.to);
  const error = (i) => one.error[i] ?? 0;
  if (one.errors === "band" && known.length > 1) {
    const upper = known.map((i) => at(one.x[i], one.y[i] + error(i)).join(" "));
    const lower = known.map((i) => at(one.x[i], one.y[i] - error(i)).join(" ")).reverse();
    svg.append(make("path", { d: `M${[...upper, ...lower].join("L")}z`, style: `fill: ${colour}; fill-opacity: 0.22` }));
  }
  if (one.errors === "bars") {
    const bars = known.map((i) => `M${at(one.x[i], one.y[i] - error(i)).join(" ")}L${at(one.x[i], one.y[i] + error(i)).join(" ")}`);
    svg.append(make("path", { d: bars.join(""), style: `stroke: ${colour}; stroke-width: 1.2` }));
  }
  const points = known.map((i) => at(one.x[i], one.y[i]));
  if (one.form === "dots" || points.length === 1) {
    svg.append(make("path", { d: points.map(([x, y]) => `M${x} ${y}${markOf(one.colour)}`).join(""), style: `fill: ${colour}` }));
    return;
  }
  const style = `fill: none; stroke: ${colour}; stroke-width: 1.8; stroke-dasharray: ${one.dash}`;
  svg.append(make("path", { d: one.form === "steps" ? stepsThrough(points) : `M${points.map((p) => p.join(" ")).join("L")}`, style }));
}

// Steps that change half-way between points; those at the ends reach as far out as in.
function stepsThrough(points) {
  const middle = (i) => (points[i - 1][0] + points[i][0]) / 2;
  const last = points.length - 1;
  const [from, to] = [2 * points[0][0] - middle(1), 2 * points[last][0] - middle(last)];
  return `M${around(from)} ` + points.map(([, y], i) => (i === 0 ? y : `H${around(middle(i))}V${y}`)).join("") + `H${around(to)}`;
}

// A line through the nearest points of all series, and their values in words.
function followChart(svg, data, { x, at, area }, readout) {
  const places = [...new Set(data.series.flatMap((one) => one.x))].filter((one) => one <= x.to).sort((a, b) => a - b);
  const cursor = make("path", { class: "cursor" });
  svg.append(cursor);
  let here = -1;
  const show = (index) => {
    if (places.length === 0) return;
    here = Math.min(Math.max(index, 0), places.length - 1);
    const lines = [];
    let marks = `M${at(places[here], 1)[0]} ${area.top}v${area.height}`;
    for (const one of data.series) {
      if (one.form === "dots" && !one.name) continue;
      const i = nearestIndex(one.x, places[here]);
      if (i < 0 || one.y[i] === null) continue;
      const [cx, cy] = at(one.x[i], one.y[i]);
      marks += `M${cx - 4} ${cy}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0`;
      const name = one.name && data.series.length > 1 ? `${one.name}: ` : "";
      lines.push(name + quantity(one.y[i], one.error[i], one.bias?.[i], data.unit));
    }
    cursor.setAttribute("d", marks);
    readout.textContent = `${data.x_name}: ${formatValue(places[here])}   ${lines.join("   ")}`;
  };
  svg.addEventListener("pointermove", (event) => {
    const share = (pointerAt(svg, event)[0] - area.left) / area.width;
    show(nearestIndex(places, x.value(Math.min(Math.max(share, 0), 1))));
  });
  svg.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    show(here + step);
  });
}

function nearestIndex(values, wanted) {
  let best = -1;
  values.forEach((value, i) => {
    if (best < 0 || Math.abs(value - wanted) < Math.abs(values[best] - wanted)) best = i;
  });
  return best;
}
