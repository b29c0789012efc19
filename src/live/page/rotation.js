// Rotations from a quaternion [w, x, y, z], body to nav.

function normalized(q) {
  const size = Math.hypot(...q);
  return size > 0 && Number.isFinite(size) ? q.map((x) => x / size) : [1, 0, 0, 0];
}

/** The matrix that turns a body vector into nav. */
function matrixOf([w, x, y, z]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
}

/** Roll, pitch and yaw in degrees, aerospace order ZYX. */
function eulerOf([w, x, y, z]) {
  const degrees = 180 / Math.PI;
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) * degrees,
    Math.asin(clamp(2 * (w * y - z * x), -1, 1)) * degrees,
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) * degrees,
  ];
}

/** The rotation a share of the way from a to b, along the shorter arc. */
function between(a, b, share) {
  let dot = a.reduce((sum, x, k) => sum + x * b[k], 0);
  const sign = dot < 0 ? -1 : 1;
  dot = Math.min(1, sign * dot);
  const angle = Math.acos(dot);
  const [u, v] = angle < 1e-6 ? [1 - share, share] : [Math.sin((1 - share) * angle), Math.sin(share * angle)];
  return normalized(a.map((x, k) => u * x + sign * v * b[k]));
}

/** A series' attitude at a time: between two points, the last one after them, null before. */
function attitudeAt(series, t) {
  const i = series.at(t);
  if (i < 0) return null;
  const point = (n) => normalized(series.columns.map((column) => column[n]));
  const here = point(i);
  const span = i + 1 < series.length ? series.first[i + 1] - series.last[i] : 0;
  const share = span > 0 ? clamp((t - series.last[i]) / span, 0, 1) : 0;
  const q = share > 0 ? between(here, point(i + 1), share) : here;
  return { q, euler_deg: eulerOf(q), rotation: matrixOf(q), age_s: span > 0 ? 0 : Math.max(0, t - series.last[i]) };
}

const apply = (m, v) => m.map((row) => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
