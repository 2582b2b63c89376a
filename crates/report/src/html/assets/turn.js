// Turning, moving and zooming the scene, and names under the pointer.

function turnScene(state) {
  const { canvas } = state;
  const middle = [SCENE.width / 2, SCENE.height / 2];
  const turn = (right, down) => {
    state.view.rows = turned(turned(state.view.rows, 1, right), 0, down);
    state.draw();
  };
  const zoom = (factor, [x, y]) => {
    const { view } = state;
    view.center = [x + (view.center[0] - x) * factor, y + (view.center[1] - y) * factor];
    view.scale *= factor;
    state.draw();
  };
  // Places of the fingers, or of the mouse, that are down on the scene.
  const down = new Map();
  const apart = () => { const [a, b] = [...down.values()]; return Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 1); };
  const place = (event) => [event.clientX, event.clientY];
  canvas.addEventListener("pointerdown", (event) => {
    if (!mayDrag(canvas.parentElement, event)) return;
    down.set(event.pointerId, place(event));
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = down.get(event.pointerId);
    if (!last) return;
    const before = down.size > 1 ? apart() : 0;
    down.set(event.pointerId, place(event));
    if (down.size > 1) return zoom(apart() / before, middle);
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    const perUnit = SCENE.width / canvas.getBoundingClientRect().width;
    if (event.shiftKey || event.buttons === 2) {
      state.view.center = [state.view.center[0] + dx * perUnit, state.view.center[1] + dy * perUnit];
      state.draw();
    } else {
      turn(0.008 * dx, 0.008 * dy);
    }
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => down.delete(event.pointerId));
  // The wheel alone scrolls the page. Browsers report a pinch on a touch pad as the wheel with Ctrl.
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY), sceneAt(canvas, event));
  }, { passive: false });
  const keys = {
    ArrowLeft: () => turn(-0.12, 0), ArrowRight: () => turn(0.12, 0), ArrowUp: () => turn(0, -0.12), ArrowDown: () => turn(0, 0.12),
    "+": () => zoom(1.25, middle), "-": () => zoom(0.8, middle), 0: () => { state.reset(); state.draw(); },
  };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
}

function sceneAt(canvas, event) {
  const box = canvas.getBoundingClientRect();
  return [((event.clientX - box.left) / box.width) * SCENE.width, ((event.clientY - box.top) / box.height) * SCENE.height];
}

function pointAtScene(state, readout) {
  const { canvas, data } = state;
  const show = (lit, words) => {
    readout.textContent = words;
    if (state.lit === lit) return;
    state.lit = lit;
    state.draw();
  };
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons !== 0) return;
    const [x, y] = sceneAt(canvas, event);
    const path = pathAt(state, x, y);
    if (path >= 0) return show(null, `path ${path + 1} of ${data.paths.length}: ${data.groups[data.paths[path].group].name}`);
    const face = faceAt(state, x, y);
    return face < 0 ? show(null, "") : show(face, `${data.faces[face].name}: ${ROLES[data.faces[face].role].name}`);
  });
  canvas.addEventListener("pointerleave", () => show(null, ""));
}

function pathAt({ lines, hidden }, x, y) {
  return lines.findIndex(({ group, screen }) => {
    if (hidden.has(group)) return false;
    for (let i = 3; i < screen.length; i += 3) {
      if (distanceToLine(x, y, [screen[i - 3], screen[i - 2]], [screen[i], screen[i + 1]]) < NEAR) return true;
    }
    return false;
  });
}

// The nearest face under the pointer.
function faceAt({ triangles, screens, hiddenFaces }, x, y) {
  let [best, nearest] = [-1, -Infinity];
  for (const { index, corners } of triangles) {
    if (hiddenFaces.has(index) || !isInTriangle(x, y, screens[index], corners)) continue;
    const nearness = corners.reduce((sum, corner) => sum + screens[index][3 * corner + 2], 0);
    if (nearness > nearest) [best, nearest] = [index, nearness];
  }
  return best;
}
