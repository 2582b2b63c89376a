// Looking at points in space: a turn, a scale and a shift, without perspective.

// Rows of the first turn: along the screen, up the screen, toward the eye.
function firstTurn(size, isUpright) {
  const longest = size.indexOf(Math.max(...size));
  const others = size.filter((_, axis) => axis !== longest);
  const isLong = size[longest] > 2 * Math.max(...others);
  // Scenes stand on their xy plane. Those that are much taller than wide lie down, unless their light comes from above.
  let rows = [[1, 0, 0], [0, 0, 1], [0, -1, 0]];
  if (longest === 1) rows = [[0, 1, 0], [0, 0, 1], [1, 0, 0]];
  if (longest === 2 && isLong && !isUpright) rows = [[0, 0, 1], [1, 0, 0], [0, 1, 0]];
  return turned(turned(rows, 1, -0.5), 0, 0.4);
}

// A turn followed by one about an axis of the screen: 0 to the right, 1 up.
function turned(rows, axis, angle) {
  const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
  const [i, j] = axis === 0 ? [1, 2] : [2, 0];
  const mix = (a, b, p, q) => a.map((part, k) => p * part + q * b[k]);
  const result = rows.map((row) => [...row]);
  result[i] = mix(rows[i], rows[j], cos, -sin);
  result[j] = mix(rows[i], rows[j], sin, cos);
  return result;
}

// All points of a flat list on the screen: x, y and nearness.
function project(points, view) {
  const { rows, middle, scale, center } = view;
  const screen = new Float32Array(points.length);
  for (let i = 0; i < points.length; i += 3) {
    const [x, y, z] = [points[i] - middle[0], points[i + 1] - middle[1], points[i + 2] - middle[2]];
    screen[i] = center[0] + scale * (rows[0][0] * x + rows[0][1] * y + rows[0][2] * z);
    screen[i + 1] = center[1] - scale * (rows[1][0] * x + rows[1][1] * y + rows[1][2] * z);
    screen[i + 2] = scale * (rows[2][0] * x + rows[2][1] * y + rows[2][2] * z);
  }
  return screen;
}

// The largest size over the faces along each axis.
function extent(faces) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { points } of faces) {
    points.forEach((value, i) => {
      low[i % 3] = Math.min(low[i % 3], value);
      high[i % 3] = Math.max(high[i % 3], value);
    });
  }
  return low.map((value, axis) => Math.max(high[axis] - value, 0));
}

// Twice the area of a triangle on the screen, and how squarely it faces the eye.
function facing(screen, [a, b, c]) {
  const [ux, uy, uz] = [0, 1, 2].map((k) => screen[3 * b + k] - screen[3 * a + k]);
  const [vx, vy, vz] = [0, 1, 2].map((k) => screen[3 * c + k] - screen[3 * a + k]);
  const normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const length = Math.hypot(...normal);
  return length > 0 ? Math.abs(normal[2]) / length : 0;
}

function isInTriangle(px, py, screen, [a, b, c]) {
  const side = (p, q) => (screen[3 * q] - screen[3 * p]) * (py - screen[3 * p + 1]) - (screen[3 * q + 1] - screen[3 * p + 1]) * (px - screen[3 * p]);
  const [ab, bc, ca] = [side(a, b), side(b, c), side(c, a)];
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

function distanceToLine(px, py, [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const share = length > 0 ? Math.min(Math.max(((px - ax) * dx + (py - ay) * dy) / length, 0), 1) : 0;
  return Math.hypot(px - ax - share * dx, py - ay - share * dy);
}
