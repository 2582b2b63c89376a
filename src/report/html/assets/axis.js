// Axes: from values to shares of a length and back, and where their ticks are.

const SCALES = {
  linear: { to: (x) => x, from: (t) => t },
  log: { to: Math.log10, from: (t) => 10 ** t },
  // Degrees that are equal in their tangents.
  tangent: { to: (x) => Math.tan((x * Math.PI) / 180), from: (t) => (Math.atan(t) * 180) / Math.PI },
};

function makeAxis(from, to, scale, label) {
  const { to: forth, from: back } = SCALES[scale];
  if (!(to > from)) to = from + (Math.abs(from) || 1);
  const [a, b] = [forth(from), forth(to)];
  return {
    from, to, scale, label,
    share: (value) => (forth(value) - a) / (b - a),
    value: (share) => back(a + share * (b - a)),
    ticks: scale === "log" ? logTicks(from, to) : linearTicks(from, to),
  };
}

function linearTicks(from, to) {
  const rough = (to - from) / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const ticks = [];
  for (let i = Math.ceil(from / step - 1e-9); i * step <= to + 1e-9 * step; i += 1) ticks.push(i === 0 ? 0 : i * step);
  return ticks;
}

function logTicks(from, to) {
  const [low, high] = [Math.ceil(Math.log10(from) - 1e-9), Math.floor(Math.log10(to) + 1e-9)];
  if (high - low < 2) return linearTicks(from, to).filter((tick) => tick >= from && tick > 0);
  const every = Math.ceil((high - low) / 7);
  const ticks = [];
  for (let exponent = low; exponent <= high; exponent += every) ticks.push(10 ** exponent);
  return ticks;
}

// Decades that a logarithmic scale shows at most.
const MOST_DECADES = 8;

// The range of some values, from zero on, or of the positive ones.
function rangeOf(values, scale) {
  const known = values.filter((value) => value !== null && Number.isFinite(value) && (scale !== "log" || value > 0));
  if (known.length === 0) return scale === "log" ? [0.1, 1] : [0, 1];
  const [low, high] = known.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
  if (scale !== "log") return [Math.min(0, low), high > 0 ? high : low < 0 ? 0 : 1];
  return [Math.max(low, high / 10 ** MOST_DECADES), high === low ? high * 10 : high];
}
