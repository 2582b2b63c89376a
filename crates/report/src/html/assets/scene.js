// The scene in three dimensions: faces from back to front, paths of light and names before them.

const SCENE = { width: 1080, height: 560, margin: 0.92 };
// How faces of each kind look: colour, opacity of their area, and of their rims.
const ROLES = {
  solid: { colour: "--series-5", fill: 0.1, rim: 0.55, name: "face of a solid" },
  sheet: { colour: "--series-3", fill: 0.1, rim: 0.55, name: "sheet" },
  port: { colour: "--soft", fill: 0.04, rim: 0.4, name: "open port" },
  pattern: { colour: "--ink", fill: 0, rim: 0.85, name: "elements of a pattern" },
  sensor: { colour: "--series-4", fill: 0.3, rim: 0.95, name: "sensor" },
  source: { colour: "--series-6", fill: 0.6, rim: 1, name: "source" },
};
// Pixels within which the pointer finds a path.
const NEAR = 5;

function drawScene(figure, data) {
  const hint = "drag or arrow keys turn, ctrl (or cmd) and the wheel, a pinch, or + and - zoom, shift and drag moves, 0 resets";
  const { controls, body, readout } = layOut(figure, "scene", hint);
  const canvas = make("canvas", { width: 2 * SCENE.width, height: 2 * SCENE.height, tabindex: "0", role: "img", "aria-label": "the scene" });
  body.append(canvas);
  const state = { data, canvas, letters: 1, hidden: new Set(), hiddenFaces: new Set(), lit: null, colours: {}, sharp: 2 };
  state.triangles = data.faces.flatMap((face, index) =>
    Array.from({ length: face.triangles.length / 3 }, (_, t) => ({ index, corners: face.triangles.slice(3 * t, 3 * t + 3) })));
  state.reset = () => {
    state.view = { rows: firstTurn(extent(data.faces), data.upright), middle: data.middle, scale: 1, center: [SCENE.width / 2, SCENE.height / 2] };
    fit(state);
  };
  state.reset();
  let waits = false;
  state.draw = () => {
    if (waits) return;
    waits = true;
    requestAnimationFrame(() => { waits = false; paint(state); });
  };
  const start = make("button", { type: "button" }, "first view");
  start.addEventListener("click", () => { state.reset(); state.draw(); });
  controls.prepend(start);
  touchSwitch(controls, body, "turn");
  body.append(groupSwitches(state), faceSwitches(state));
  if (data.axes) body.append(axesSwitches(state));
  turnScene(state);
  pointAtScene(state, readout);
  document.addEventListener("repaint", () => { readColours(state); paint(state); });
  readColours(state);
  // Letters keep their size on a narrow screen, where the picture is small.
  drawToFit(body, (width) => { state.letters = Math.max(1, (0.85 * SCENE.width) / width); paint(state); });
}

// A scale at which all faces are in the picture.
function fit({ data, view }) {
  let reach = [1e-9, 1e-9];
  for (const { points } of data.faces) {
    const screen = project(points, { ...view, center: [0, 0] });
    for (let i = 0; i < screen.length; i += 3) {
      reach = [Math.max(reach[0], Math.abs(screen[i])), Math.max(reach[1], Math.abs(screen[i + 1]))];
    }
  }
  view.scale = (SCENE.margin / 2) * Math.min(SCENE.width / reach[0], SCENE.height / reach[1]);
}

// Style sheets know the colours; a canvas wants them as numbers.
function readColours(state) {
  const probe = make("span");
  state.canvas.parentElement.append(probe);
  const names = ["--paper", "--ink", "--soft", ...Object.values(ROLES).map((role) => role.colour), ...[0, 1, 2, 3, 4, 5, 6].map((i) => `--series-${i}`)];
  for (const name of names) {
    probe.style.color = `var(${name})`;
    state.colours[name] = getComputedStyle(probe).color;
  }
  probe.remove();
}

function paint(state) {
  const { canvas, data, view, colours, hiddenFaces, sharp } = state;
  const context = canvas.getContext("2d");
  context.setTransform(sharp, 0, 0, sharp, 0, 0);
  context.clearRect(0, 0, SCENE.width, SCENE.height);
  context.lineJoin = "round";
  state.screens = data.faces.map((face) => project(face.points, view));
  const nearness = ({ index, corners }) => corners.reduce((sum, corner) => sum + state.screens[index][3 * corner + 2], 0);
  const sorted = state.triangles.filter((one) => !hiddenFaces.has(one.index)).map((one) => [nearness(one), one]);
  sorted.sort((a, b) => a[0] - b[0]);
  for (const [, { index, corners }] of sorted) paintTriangle(context, state, index, corners);
  const paintRimsOf = (wanted) => data.faces.forEach((face, index) => {
    if (!hiddenFaces.has(index) && wanted(face.role === "pattern")) paintRims(context, state, face, index);
  });
  paintRimsOf((isPattern) => !isPattern);
  paintPaths(context, state);
  // Elements are small, and paths go through them: they would not be seen behind.
  paintRimsOf((isPattern) => isPattern);
  paintAxes(context, state);
  const taken = [];
  for (const mark of data.marks) paintMark(context, state, mark, taken);
  context.globalAlpha = 1;
  paintScale(context, view, state);
}

function paintTriangle(context, state, index, corners) {
  const role = ROLES[state.data.faces[index].role];
  const screen = state.screens[index];
  const isLit = state.lit === index;
  context.globalAlpha = isLit ? 0.35 : role.fill * (0.6 + 0.8 * (1 - facing(screen, corners)));
  context.fillStyle = isLit ? state.colours["--ink"] : state.colours[role.colour];
  context.beginPath();
  corners.forEach((corner) => context.lineTo(screen[3 * corner], screen[3 * corner + 1]));
  context.fill();
}

function paintRims(context, state, face, index) {
  const role = ROLES[face.role];
  const screen = state.screens[index];
  context.globalAlpha = role.rim;
  context.strokeStyle = state.colours[role.colour];
  context.lineWidth = state.lit === index ? 2 : 1;
  context.beginPath();
  for (const rim of face.rims) rim.forEach((corner, i) => context[i === 0 ? "moveTo" : "lineTo"](screen[3 * corner], screen[3 * corner + 1]));
  context.stroke();
}

function paintPaths(context, state) {
  const { data, view, colours, hidden } = state;
  state.lines = data.paths.map((path) => ({ group: path.group, screen: project(path.points, view) }));
  for (const { group, screen } of state.lines.filter((line) => !hidden.has(line.group))) {
    context.globalAlpha = 0.45;
    context.strokeStyle = colours[`--series-${group % 7}`];
    context.fillStyle = context.strokeStyle;
    context.lineWidth = 0.9;
    context.setLineDash(group < 7 ? [] : [6, 3]);
    context.beginPath();
    for (let i = 0; i < screen.length; i += 3) context.lineTo(screen[i], screen[i + 1]);
    context.stroke();
    context.setLineDash([]);
    paintEnd(context, data.groups[group].fate, screen.at(-3), screen.at(-2));
  }
}

// Ends differ in their form as well as in their colour.
function paintEnd(context, fate, x, y) {
  context.globalAlpha = 1;
  context.lineWidth = 1.5;
  context.beginPath();
  if (fate === "counted") { context.arc(x, y, 3, 0, 7); context.fill(); return; }
  if (fate === "escaped") context.arc(x, y, 3, 0, 7);
  if (fate === "absorbed") { context.moveTo(x - 3, y - 3); context.lineTo(x + 3, y + 3); context.moveTo(x + 3, y - 3); context.lineTo(x - 3, y + 3); }
  if (fate === "lost") context.rect(x - 3, y - 3, 6, 6);
  context.stroke();
}

// A name beside its place, where no other name is yet.
function paintMark(context, { view, colours, letters }, { name, role, at }, taken) {
  const [x, y] = project(at, view);
  context.globalAlpha = 1;
  context.fillStyle = colours[ROLES[role].colour];
  context.beginPath();
  context.arc(x, y, 4, 0, 7);
  context.fill();
  context.font = `600 ${14 * letters}px system-ui, sans-serif`;
  context.lineWidth = 4 * letters;
  context.strokeStyle = colours["--paper"];
  const width = context.measureText(name).width;
  const left = x + 8 + width > SCENE.width ? x - 8 - width : x + 8;
  let base = role === "source" ? y + 16 * letters : y - 8;
  const isTaken = (one) => Math.abs(one.base - base) < 15 * letters && one.left < left + width && left < one.left + one.width;
  while (taken.some(isTaken)) base -= 15 * letters;
  taken.push({ left, base, width });
  context.strokeText(name, left, base);
  context.fillStyle = colours["--ink"];
  context.fillText(name, left, base);
}

// A length of about a tenth of the picture, and which way the axes go.
function paintScale(context, { rows, scale }, { colours, letters }) {
  const length = 10 ** Math.floor(Math.log10(160 / scale));
  const shown = length * [5, 2, 1].find((factor) => factor * length * scale <= 160);
  context.strokeStyle = colours["--ink"];
  context.fillStyle = colours["--ink"];
  context.lineWidth = 2;
  context.font = `${13 * letters}px system-ui, sans-serif`;
  context.beginPath();
  context.moveTo(20, SCENE.height - 16);
  context.lineTo(20 + shown * scale, SCENE.height - 16);
  context.stroke();
  context.fillText(`${formatValue(shown)} mm`, 20, SCENE.height - 24);
  const arm = 30 * letters;
  const [cx, cy] = [SCENE.width - 2 * arm, SCENE.height - 1.6 * arm];
  ["x", "y", "z"].forEach((axis, k) => {
    const [dx, dy] = [arm * rows[0][k], -arm * rows[1][k]];
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(cx, cy);
    context.lineTo(cx + dx, cy + dy);
    context.stroke();
    context.fillText(axis, cx + 1.3 * dx - 4, cy + 1.3 * dy + 4);
  });
}

function groupSwitches(state) {
  const legend = make("div", { class: "legend", role: "group", "aria-label": "paths by their end" });
  state.data.groups.forEach(({ name, count }, group) => {
    const swatch = make("span", { class: "swatch", style: `border-color: ${seriesColour(group % 7)}` });
    legend.append(toggle([swatch, `${name} (${count})`], state.hidden, group, state.draw));
  });
  return legend;
}

function faceSwitches(state) {
  const legend = make("div", { class: "legend" });
  state.data.faces.forEach((face, index) => {
    const button = toggle([face.name], state.hiddenFaces, index, () => state.draw());
    button.title = ROLES[face.role].name;
    const light = (lit) => { state.lit = lit; state.draw(); };
    button.addEventListener("pointerenter", () => light(index));
    button.addEventListener("focus", () => light(index));
    button.addEventListener("pointerleave", () => light(null));
    button.addEventListener("blur", () => light(null));
    legend.append(button);
  });
  return make("details", {}, make("summary", {}, `${state.data.faces.length} faces, sensors and sources`), legend);
}

function toggle(content, hidden, key, draw) {
  const button = make("button", { type: "button", "aria-pressed": "true" }, ...content);
  button.addEventListener("click", () => {
    const isHidden = !hidden.has(key);
    if (isHidden) hidden.add(key);
    else hidden.delete(key);
    button.setAttribute("aria-pressed", String(!isHidden));
    draw();
  });
  return button;
}
