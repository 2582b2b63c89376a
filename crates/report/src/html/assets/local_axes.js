// Local axes of faces and sensors in the scene: u, v and the normal n, or C0, C90 and the pole of a goniometer.

// Length of an axis in pixels.
const AXIS_LENGTH = 34;

function axesSwitches(state) {
  const axes = state.data.axes ?? [];
  state.shownAxes = new Set(axes.flatMap((one, index) => (one.role === "sensor" ? [index] : [])));
  const legend = make("div", { class: "legend" });
  axes.forEach((one, index) => {
    const button = make("button", { type: "button", "aria-pressed": String(state.shownAxes.has(index)) }, one.name);
    button.addEventListener("click", () => {
      const shows = !state.shownAxes.has(index);
      if (shows) state.shownAxes.add(index);
      else state.shownAxes.delete(index);
      button.setAttribute("aria-pressed", String(shows));
      state.draw();
    });
    legend.append(button);
  });
  return make("details", { open: "", class: "axes" }, make("summary", {}, `local axes of ${axes.length} faces and sensors`), legend);
}

function paintAxes(context, { data, view, colours, shownAxes, letters }) {
  (data.axes ?? []).forEach((one, index) => {
    if (!shownAxes.has(index)) return;
    const [x, y] = project(one.at, view);
    const names = one.round ? ["C0", "C90", "pole"] : ["u", "v", "n"];
    context.globalAlpha = 1;
    context.font = `600 ${12 * letters}px system-ui, sans-serif`;
    names.forEach((name, k) => {
      const along = one.axes.slice(3 * k, 3 * k + 3);
      const [dx, dy] = [0, 1].map((row) => letters * AXIS_LENGTH * along.reduce((sum, part, i) => sum + part * view.rows[row][i], 0));
      context.lineWidth = 2;
      context.strokeStyle = colours[`--series-${[0, 1, 2][k]}`];
      context.fillStyle = context.strokeStyle;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + dx, y - dy);
      context.stroke();
      paintTip(context, x + dx, y - dy, Math.atan2(-dy, dx));
      context.lineWidth = 3;
      context.strokeStyle = colours["--paper"];
      context.strokeText(name, x + 1.25 * dx - 4, y - 1.25 * dy + 4);
      context.fillText(name, x + 1.25 * dx - 4, y - 1.25 * dy + 4);
    });
  });
}

function paintTip(context, x, y, angle) {
  context.beginPath();
  context.moveTo(x, y);
  for (const side of [-0.45, 0.45]) context.lineTo(x - 8 * Math.cos(angle + side), y - 8 * Math.sin(angle + side));
  context.fill();
}
