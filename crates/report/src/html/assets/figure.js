// What all plots are made of: elements, controls, and the frame with its axes.

const SVG = "http://www.w3.org/2000/svg";
const SVG_NAMES = new Set(["svg", "g", "path", "line", "rect", "circle", "text", "image", "polyline", "title", "tspan"]);

function make(name, attributes = {}, ...children) {
  const element = SVG_NAMES.has(name) ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

// A row of controls, a place for the plot, and a line that tells values.
function layOut(figure, kind, hint) {
  const parts = {
    controls: make("div", { class: "controls" }),
    body: make("div", { class: `plot ${kind}` }),
    readout: make("output", { class: "readout" }),
  };
  if (hint) parts.controls.append(make("span", { class: "hint" }, hint));
  figure.append(parts.controls, parts.body, parts.readout);
  return parts;
}

// A button that switches between a linear and a logarithmic scale, where there are both.
function scaleSwitch(controls, scales, draw) {
  if (scales.log) stateSwitch(controls, "log scale", (isLog) => draw(isLog ? "log" : "linear"));
  draw("linear");
}

// A button that turns something on and off.
function stateSwitch(controls, words, act, kind = "scale") {
  const button = make("button", { type: "button", class: kind, "aria-pressed": "false" }, words);
  button.addEventListener("click", () => {
    const isOn = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(isOn));
    act(isOn);
  });
  controls.prepend(button);
}

// Draws at the width that there is, and again when it changes, so that letters keep their size on a narrow screen.
// `draw` gets the width in pixels. On paper a drawing is scaled as a whole.
function drawToFit(body, draw) {
  let drawn = 0;
  const drawAgain = () => {
    const width = Math.floor(body.clientWidth);
    if (width === 0 || width === drawn || matchMedia("print").matches) return;
    drawn = width;
    draw(width);
  };
  const again = () => { drawn = 0; drawAgain(); };
  new ResizeObserver(() => requestAnimationFrame(drawAgain)).observe(body);
  return again;
}

// A button that makes a finger draw or turn, where it scrolls the page otherwise. A mouse needs none.
function touchSwitch(controls, target, words) {
  stateSwitch(controls, words, (isOn) => target.classList.toggle("grabbed", isOn), "touch");
}

// Whether a press of the pointer may draw or turn: that of a mouse always, that of a finger where it was asked to.
const mayDrag = (target, event) => event.pointerType !== "touch" || target.classList.contains("grabbed");

// An empty drawing of `width` by `height` units.
function drawing(width, height, label) {
  const viewBox = `0 0 ${around(width)} ${around(height)}`;
  return make("svg", { viewBox, role: "img", "aria-label": label, tabindex: "0", style: `max-width: ${around(width)}px` });
}

// Where the pointer is, in the units of a drawing.
function pointerAt(svg, event) {
  const box = svg.getBoundingClientRect();
  const { width, height } = svg.viewBox.baseVal;
  return [((event.clientX - box.left) / box.width) * width, ((event.clientY - box.top) / box.height) * height];
}

const around = (number) => Math.round(number * 100) / 100;

// Axes about a rectangle: grid, ticks and names. Gives back where a pair of values lies.
function drawAxes(svg, area, x, y, grid) {
  const { left, top, width, height } = area;
  const place = (a, b) => [left + x.share(a) * width, top + (1 - y.share(b)) * height];
  const lines = { grid: "", axis: `M${left} ${top}h${width}v${height}h${-width}z` };
  const column = (value) => around(left + x.share(value) * width);
  const row = (value) => around(top + (1 - y.share(value)) * height);
  for (const [value] of x.ticks) {
    lines.grid += `M${column(value)} ${top}v${height}`;
    lines.axis += `M${column(value)} ${top + height}v5`;
  }
  for (const value of x.minor) lines.axis += `M${column(value)} ${top + height}v3`;
  for (const [at, words] of withRoom(x.ticks.map(([value, words]) => [column(value), words]))) {
    svg.append(make("text", { x: at, y: top + height + 18, "text-anchor": "middle" }, words));
  }
  for (const [value, words] of y.ticks) {
    lines.grid += `M${left} ${row(value)}h${width}`;
    lines.axis += `M${left} ${row(value)}h-5`;
    svg.append(make("text", { x: left - 8, y: row(value) + 4, "text-anchor": "end" }, words));
  }
  for (const value of y.minor) lines.axis += `M${left} ${row(value)}h-3`;
  if (grid === "grid") svg.append(make("path", { d: lines.grid, class: "grid" }));
  svg.append(make("path", { d: lines.axis, class: "axis" }));
  lines.label = wrapped(x.label, left + width + 10);
  const half = Math.max(...lines.label.map(widthOf)) / 2;
  lines.label.forEach((words, line) => {
    const at = Math.max(left + width / 2, half);
    svg.append(make("text", { x: around(at), y: top + height + 36 + 15 * line, "text-anchor": "middle" }, words));
  });
  const middle = top + height / 2;
  const turned = { x: 14, y: middle, "text-anchor": "middle", transform: `rotate(-90 14 ${middle})` };
  svg.append(make("text", turned, y.label));
  return place;
}

const seriesColour = (colour) => (colour === "soft" ? "var(--soft)" : `var(--series-${colour})`);
// Dots differ in their form, too: colours alone do not tell them apart for everyone.
const markOf = (colour) => ["m-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0", "m-3 -3h6v6h-6z", "m0 -4l4 7h-8z", "m0 -4l4 4l-4 4l-4 -4z"][colour % 4];

// Names of series with samples of their lines.
function legendOf(series) {
  const legend = make("div", { class: "legend" });
  for (const one of series.filter(({ name }) => name)) {
    const colour = seriesColour(one.colour);
    const sample =
      one.form === "dots"
        ? make("path", { d: `M15 5${markOf(one.colour)}`, style: `fill: ${colour}` })
        : make("path", { d: "M0 5h30", style: `stroke: ${colour}; stroke-width: 2.4; stroke-dasharray: ${one.dash}` });
    legend.append(make("span", {}, make("svg", { class: "sample", width: 30, height: 10 }, sample), one.name));
  }
  return legend;
}

// About how wide words are in the letters of a drawing: 12 pixels high.
const widthOf = (words) => 6.8 * words.length;

// Labels at places along a line, without those that would touch the one before.
function withRoom(labels) {
  for (let every = 1; every < labels.length; every += 1) {
    const kept = labels.filter((_, i) => i % every === 0);
    const touches = ([at, words], i) => i > 0 && at - kept[i - 1][0] < (widthOf(words) + widthOf(kept[i - 1][1])) / 2 + 8;
    if (!kept.some(touches)) return kept;
  }
  return labels.slice(0, 1);
}

// Words in lines of at most this many pixels.
function wrapped(words, width) {
  const lines = [""];
  for (const word of words.split(" ")) {
    const longer = lines.at(-1) ? `${lines.at(-1)} ${word}` : word;
    if (lines.at(-1) && widthOf(longer) > width) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}
