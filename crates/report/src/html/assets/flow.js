// The flux balance: a band from the sources that parts to where the light went.

const FLOW = { width: 900, band: 300, left: 180, right: 420, gap: 24, top: 30 };
// Where there is less room than this, pixels, the words take two lines.
const FLOW_SLIM = { below: 620, band: 240, left: 34, right: 110, gap: 40, top: 44 };
// Lines that are drawn one by one.
const FLOW_LINES = 14;

function drawFlow(figure, data) {
  const { body, readout } = layOut(figure, "flow", "");
  drawToFit(body, (width) => {
    const size = width < FLOW_SLIM.below ? { ...FLOW_SLIM, width, isSlim: true } : { ...FLOW, isSlim: false };
    body.replaceChildren(flowDrawing(data, size, readout));
  });
}

function flowDrawing(data, size, readout) {
  const sinks = fewSinks(data);
  const perUnit = size.band / data.whole;
  const room = size.isSlim ? 34 : 26;
  const tallest = Math.max(heightOf(data.sources, perUnit, room), heightOf(sinks, perUnit, size.gap));
  const svg = drawing(size.width, size.top + tallest + 28, "flux balance");
  const middle = size.top + tallest / 2;
  const sources = stack(data.sources, perUnit, middle, room);
  const ends = stack(sinks, perUnit, middle, size.gap);
  const amount = (one) => (one.error === undefined ? `${formatValue(one.value)} ${data.unit}` : quantity(one.value, one.error, null, data.unit));
  const share = (one) => `${fixed((100 * one.value) / data.whole, 2)} %`;
  const words = (one) => `${one.name} ${amount(one)}`;
  // Name and amount one after the other, or one above the other.
  const write = (x, y, [name, rest]) => {
    if (!size.isSlim) return svg.append(make("text", { x, y }, `${name} ${rest}`));
    const room = Math.floor((size.width - x) / widthOf("n"));
    const short = name.length > room ? `${name.slice(0, room - 1)}…` : name;
    svg.append(make("text", { x, y: y - 8 }, short), make("text", { x, y: y + 8, class: "soft" }, rest));
  };
  let start = middle - size.band / 2;
  svg.append(make("rect", { x: size.left - 12, y: start, width: 12, height: size.band, style: "fill: var(--soft)" }));
  sources.forEach((one) => {
    band(svg, { from: [size.isSlim ? 0 : 60, one.at], to: [size.left - 12, start], size: one.size, colour: "var(--series-6)", words: words(one) }, readout);
    write(0, one.at - (size.isSlim ? 14 : 6), [data.sources.length > 1 ? one.name : `emitted: ${one.name}`, amount(one)]);
    start += one.size;
  });
  start = middle - size.band / 2;
  for (const one of ends) {
    const colour = seriesColour({ escaped: 0, absorbed: 1, medium: 2, lost: 4 }[one.kind]);
    band(svg, { from: [size.left, start], to: [size.right, one.at], size: one.size, colour, words: `${words(one)}, ${share(one)}` }, readout);
    svg.append(make("rect", { x: size.right, y: one.at, width: 8, height: Math.max(one.size, 1), style: `fill: ${colour}` }));
    write(size.right + 16, one.at + one.size / 2 + 4, [one.name, `${amount(one)}   ${share(one)}`]);
    start += one.size;
  }
  return svg;
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

// Room that a band takes: its own, and no less than a line of text.
const roomOf = (one, perUnit, room) => Math.max(perUnit * one.value + 6, room);
const heightOf = (lines, perUnit, room) => lines.reduce((sum, one) => sum + roomOf(one, perUnit, room), 0);

// Places of bands on top of each other.
function stack(lines, perUnit, middle, room) {
  let top = middle - heightOf(lines, perUnit, room) / 2;
  return lines.map((one) => {
    const [size, height] = [perUnit * one.value, roomOf(one, perUnit, room)];
    const at = top + (height - size) / 2;
    top += height;
    return { ...one, size, at };
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
