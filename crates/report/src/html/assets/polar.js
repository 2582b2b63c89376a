// Intensity by angle in planes through the pole, which points up.

// Largest size; beside the outermost circle there is room for the degrees.
const POLAR = { width: 620, radius: 232, top: 34, beside: 40 };

function drawPolar(figure, data) {
  const { controls, body, readout } = layOut(figure, "polar", "point at an angle for values; arrow keys step");
  let scale = "linear";
  const again = drawToFit(body, (width) => body.replaceChildren(polarDrawing(data, scale, readout, width), legendOf(data.curves)));
  scaleSwitch(controls, data.axes, (wanted) => { scale = wanted; again(); });
}

function polarDrawing(data, scale, readout, room) {
  const { top } = POLAR;
  const width = Math.min(POLAR.width, room);
  const radius = Math.min(POLAR.radius, width / 2 - POLAR.beside);
  const axis = axisOf(data.axes[scale]);
  const isDown = data.curves.some((curve) => curve.gamma.some((gamma, i) => Math.abs(gamma) > 90.000001 && curve.y[i] > 0));
  const center = [width / 2, top + radius];
  const svg = drawing(width, top + radius * (isDown ? 2 : 1) + 40, data.title);
  const at = (gamma, value) => {
    // Bands may reach a little beyond the outermost circle.
    const share = Math.min(Math.max(axis.share(value), 0), 1.05);
    const angle = (gamma * Math.PI) / 180;
    return [center[0] + share * radius * Math.sin(angle), center[1] - share * radius * Math.cos(angle)];
  };
  drawPolarGrid(svg, axis, [...center, radius], isDown);
  data.curves.forEach((curve) => {
    const points = curve.gamma.map((gamma, i) => at(gamma, curve.y[i] ?? 0).map(around).join(" "));
    const outer = curve.gamma.map((gamma, i) => at(gamma, (curve.y[i] ?? 0) + (curve.error[i] ?? 0)).map(around).join(" "));
    const inner = curve.gamma.map((gamma, i) => at(gamma, Math.max((curve.y[i] ?? 0) - (curve.error[i] ?? 0), 0)).map(around).join(" "));
    const colour = seriesColour(curve.colour);
    svg.append(make("path", { d: `M${[...outer, ...inner.reverse()].join("L")}z`, style: `fill: ${colour}; fill-opacity: 0.22` }));
    const style = `fill: none; stroke: ${colour}; stroke-width: 1.8; stroke-dasharray: ${curve.dash}`;
    svg.append(make("path", { d: `M${points.join("L")}`, style }));
  });
  followPolar(svg, data, [...center, radius], at, readout);
  return svg;
}

function drawPolarGrid(svg, axis, [cx, cy, radius], isDown) {
  const circle = (r) => (isDown ? `M${cx - r} ${cy}a${r} ${r} 0 1 1 ${2 * r} 0a${r} ${r} 0 1 1 ${-2 * r} 0` : `M${cx - r} ${cy}a${r} ${r} 0 1 1 ${2 * r} 0`);
  let lines = circle(radius);
  const last = isDown ? 180 : 90;
  for (let angle = -last; angle <= last; angle += 30) {
    const [sin, cos] = [Math.sin((angle * Math.PI) / 180), Math.cos((angle * Math.PI) / 180)];
    lines += `M${cx} ${cy}L${around(cx + radius * sin)} ${around(cy - radius * cos)}`;
    if (angle === -180) continue;
    const anchor = Math.abs(sin) < 0.1 ? "middle" : sin > 0 ? "start" : "end";
    const [x, y] = [cx + (radius + 8) * sin, cy - (radius + 8) * cos + (cos > 0.5 ? 0 : cos < -0.5 ? 10 : 4)];
    svg.append(make("text", { x: around(x), y: around(y), "text-anchor": anchor, class: "soft" }, `${Math.abs(angle)}°`));
  }
  for (const [value] of axis.ticks.filter(([one]) => axis.share(one) > 0.02)) lines += circle(around(axis.share(value) * radius));
  svg.append(make("path", { d: lines, class: "grid" }));
  for (const [value, words] of axis.ticks.filter(([one]) => axis.share(one) > 0.1)) {
    svg.append(make("text", { x: cx + 4, y: around(cy - axis.share(value) * radius - 3), class: "soft" }, words));
  }
  svg.append(make("text", { x: 2 * cx, y: 16, "text-anchor": "end" }, axis.label));
}

function followPolar(svg, data, [cx, cy, radius], at, readout) {
  const cursor = make("path", { class: "cursor" });
  svg.append(cursor);
  const gammas = data.curves[0]?.gamma ?? [];
  let here = nearestIndex(gammas, 0);
  const show = (index) => {
    if (gammas.length === 0) return;
    here = (index + gammas.length) % gammas.length;
    const gamma = gammas[here];
    const angle = (gamma * Math.PI) / 180;
    let marks = `M${cx} ${cy}l${around(radius * Math.sin(angle))} ${around(-radius * Math.cos(angle))}`;
    const words = data.curves.map((curve) => {
      const i = nearestIndex(curve.gamma, gamma);
      const [x, y] = at(curve.gamma[i], curve.y[i] ?? 0);
      marks += `M${around(x - 4)} ${around(y)}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0`;
      return `${curve.name}: ${quantity(curve.y[i], curve.error[i], null, data.unit)}`;
    });
    cursor.setAttribute("d", marks);
    readout.textContent = `γ ${formatValue(gamma)}°   ${words.join("   ")}`;
  };
  svg.addEventListener("pointermove", (event) => {
    const [x, y] = pointerAt(svg, event);
    show(nearestIndex(gammas, (Math.atan2(x - cx, cy - y) * 180) / Math.PI));
  });
  svg.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    show(here + step);
  });
}
