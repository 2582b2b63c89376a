// Axes as they come with the data: ends, scale, label and marks, those of the pictures. Here values only become shares of
// a length and back.

const SCALES = {
  linear: { to: (x) => x, from: (t) => t },
  log: { to: Math.log10, from: (t) => 10 ** t },
  // Degrees that are equal in their tangents.
  tangent: { to: (x) => Math.tan((x * Math.PI) / 180), from: (t) => (Math.atan(t) * 180) / Math.PI },
};

function axisOf(described) {
  const { from, to, scale } = described;
  const { to: forth, from: back } = SCALES[scale];
  const [a, b] = [forth(from), forth(to)];
  return {
    ...described,
    // Nothing has no place on a logarithmic axis: it lies below.
    share: (value) => (scale === "log" && !(value > 0) ? -1 : (forth(value) - a) / (b - a)),
    value: (share) => back(a + share * (b - a)),
  };
}

// The axis of a path of some length: the shortest that holds it, with the marks that lie on the path.
function axisAlong(axes, length, label) {
  const { ticks, minor, label: factor } = axes.findLast((axis) => axis.to >= length * (1 - 1e-9)) ?? axes[0];
  const isOn = (at) => at <= length * (1 + 1e-9);
  return axisOf({
    from: 0, to: length || 1, scale: "linear", label: factor ? `${label}, ${factor}` : label,
    ticks: ticks.filter(([at]) => isOn(at)), minor: minor.filter(isOn),
  });
}
