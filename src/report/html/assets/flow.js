// The flux balance: a band from the sources that parts to where the light went.

const FLOW = { width: 900, band: 300, left: 180, right: 420, gap: 24, top: 30 };
// Lines that are drawn one by one.
const FLOW_LINES = 14;

function drawFlow(figure, data) {
  const { body, readout } = layOut(figure, "flow", "");
  const sinks = fewSinks(data);
  const rows = Math.max(sinks.length, data.sources.length);
  const height = Math.max(FLOW.band + (sinks.length - 1) * 8, rows * FLOW.gap) + FLOW.top + 20;
  const svg = drawing(FLOW.width, height, "flux balance");
  const middle = FLOW.top + (height - FLOW.top - 20) / 2;
  const sources = stack(data.sources, data.whole, middle, 26);
  const ends = stack(sinks, data.whole, middle, FLOW.gap);
  const words = (one) => `${one.name} ${one.error === undefined ? formatValue(one.value) + " " + data.unit : quantity(one.value, one.error, null, data.unit)}`;
  const share = (one) => `${fixed((100 * one.value) / data.whole, 2)} %`;
  let [start] = [middle - FLOW.band / 2];
  svg.append(make("rect", { x: FLOW.left - 12, y: start, width: 12, height: FLOW.band, style: "fill: var(--soft)" }));
  sources.forEach((one, index) => {
    band(svg, { from: [60, one.at], to: [FLOW.left - 12, start], size: one.size, colour: "var(--series-6)", words: words(one) }, readout);
    svg.append(make("text", { x: 0, y: one.at - 6 }, data.sources.length > 1 || index > 0 ? words(one) : `emitted: ${words(one)}`));
    start += one.size;
  });
  start = middle - FLOW.band / 2;
  for (const one of ends) {
    const colour = seriesColour({ escaped: 0, absorbed: 1, medium: 2, lost: 4 }[one.kind]);
    band(svg, { from: [FLOW.left, start], to: [FLOW.right, one.at], size: one.size, colour, words: `${words(one)}, ${share(one)}` }, readout);
    svg.append(make("rect", { x: FLOW.right, y: one.at, width: 8, height: Math.max(one.size, 1), style: `fill: ${colour}` }));
    svg.append(make("text", { x: FLOW.right + 16, y: one.at + one.size / 2 + 4 }, `${words(one)}   ${share(one)}`));
    start += one.size;
  }
  body.append(svg);
}

// The largest, and all others as one.
function fewSinks(data) {
  const sorted = data.sinks.filter((one) => one.value > 0).sort((a, b) => b.value - a.value);
  const [kept, rest] = [sorted.slice(0, FLOW_LINES), sorted.slice(FLOW_LINES)];
  if (rest.length > 0) {
    const value = rest.reduce((sum, one) => sum + one.value, 0);
    kept.push({ name: `${rest.length} smaller lines`, kind: "lost", value });
  }
  return kept;
}

// Places of bands on top of each other, with room for a line of text each.
function stack(lines, whole, middle, room) {
  const sized = lines.map((one) => ({ ...one, size: (FLOW.band * one.value) / whole }));
  const total = sized.reduce((sum, one) => sum + Math.max(one.size + 6, room), 0);
  let top = middle - total / 2;
  return sized.map((one) => {
    const height = Math.max(one.size + 6, room);
    const at = top + (height - one.size) / 2;
    top += height;
    return { ...one, at };
  });
}

function band(svg, { from: [x0, y0], to: [x1, y1], size, colour, words }, readout) {
  const thick = Math.max(size, 0.8);
  const half = (x0 + x1) / 2;
  const [a, b, c, d] = [y0, y1, y1 + thick, y0 + thick].map(around);
  const path = make("path", {
    d: `M${x0} ${a}C${half} ${a} ${half} ${b} ${x1} ${b}V${c}C${half} ${c} ${half} ${d} ${x0} ${d}z`,
    style: `fill: ${colour}; fill-opacity: 0.45`,
  }, make("title", {}, words));
  path.addEventListener("pointerenter", () => { readout.textContent = words; });
  svg.append(path);
}
