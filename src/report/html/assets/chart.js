// Curves with error bars or bands, steps and dots, over one axis; values under the pointer.

// Largest sizes of a chart, and of a section beside its map.
const WIDE = { width: 760, height: 380 };
const NARROW = { width: 500, height: 340 };

function drawChart(figure, data) {
  const { controls, body, readout } = layOut(figure, "chart", "point at the plot for values; arrow keys step");
  let scale = "linear";
  const again = drawToFit(body, (width) => body.replaceChildren(...chartOf(data, scale, readout, fitted(WIDE, width))));
  scaleSwitch(controls, (wanted) => { scale = wanted; again(); });
}

// A size within a width, and not much flatter than it was.
const fitted = (size, width) => ({ width: Math.min(size.width, width), height: Math.min(size.height, Math.max(0.8 * width, 240)) });

// The drawing of a chart and its legend. `scale` is that of the vertical axis.
function chartOf(data, scale, readout, { width, height }) {
  const svg = drawing(width, height, data.title);
  const below = 49 + 15 * wrapped(data.x_label, width - 8).length;
  const area = { left: 78, top: 12, width: width - 96, height: height - below };
  const xs = data.series.flatMap((one) => [...one.x, ...(data.whole_steps ? endsOf(one) : [])]);
  // A line beside the sensor cuts nothing.
  if (xs.length === 0) xs.push(0, 1);
  const last = scale === "linear" && data.linear_to ? data.linear_to : Math.max(...xs);
  const room = data.tight ? 0.03 * (last - Math.min(...xs)) : 0;
  const x = makeAxis(Math.min(...xs) - room, last + room, data.x_scale, data.x_label);
  const tops = data.series.flatMap((one) => one.y.map((value, i) => value === null ? null : value + (scale === "log" ? 0 : one.error[i] ?? 0)));
  const [low, high] = data.tight && scale === "linear" ? tightRangeOf(data.series) : rangeOf(tops, scale);
  const y = makeAxis(low, scale === "log" ? high * 1.3 : data.tight ? high : high * 1.05, scale, data.y_label);
  const place = drawAxes(svg, area, x, y, "grid");
  const clamp = ([a, b]) => [around(a), around(Math.min(Math.max(b, area.top), area.top + area.height))];
  const at = (a, b) => clamp(scale === "log" && !(b > 0) ? [place(a, high)[0], 1e9] : place(a, b));
  data.series.forEach((one) => drawSeries(svg, one, x, at, data.whole_steps ? endsOf(one).map((end) => at(end, 1)[0]) : []));
  followChart(svg, data, { x, at, area }, readout);
  return [svg, legendOf(data.series)];
}

// From the least to the greatest value with their errors, and a little room: small differences are what a study looks for.
function tightRangeOf(series) {
  const known = series.flatMap((one) => one.y.flatMap((value, i) => value === null ? [] : [value - (one.error[i] ?? 0), value + (one.error[i] ?? 0)]));
  if (known.length === 0) return [0, 1];
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const room = 0.05 * (high - low || Math.abs(high) || 1);
  return [low - room, high + room];
}

function drawSeries(svg, one, x, at, ends) {
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
    svg.append(make("path", { d: points.map(([x, y]) => `M${x} ${y}${markOf(one.dash)}`).join(""), style: `fill: ${colour}` }));
    return;
  }
  const style = `fill: none; stroke: ${colour}; stroke-width: 1.8; stroke-dasharray: ${dashOf(one.dash)}`;
  svg.append(make("path", { d: one.form === "steps" ? stepsThrough(points, ends) : `M${points.map((p) => p.join(" ")).join("L")}`, style }));
}

// Where the first and the last of evenly spaced steps end.
function endsOf({ form, x }) {
  if (form !== "steps" || x.length < 2) return [];
  return [x[0] - (x[1] - x[0]) / 2, x.at(-1) + (x.at(-1) - x.at(-2)) / 2];
}

// Steps that change half-way between points; those at the ends go on to `ends`, if there are any.
function stepsThrough(points, ends) {
  return points
    .map(([x, y], i) => {
      const middle = i === 0 ? x : (points[i - 1][0] + x) / 2;
      return i === 0 ? `M${ends[0] ?? x} ${y}` : `H${around(middle)}V${y}`;
    })
    .join("") + `H${ends[1] ?? points.at(-1)?.[0] ?? 0}`;
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
    readout.textContent = `${data.x_label}: ${formatValue(places[here])}   ${lines.join("   ")}`;
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
