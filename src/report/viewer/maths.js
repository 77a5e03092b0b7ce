// Rigid motions as twelve numbers: three columns of the turn, then the shift. Angles in radians, f64 throughout.
const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));

// The point moved; `at` is where its numbers start in a longer list.
function carried(m, p, at = 0) {
  const [x, y, z] = p;
  return [0, 1, 2].map((k) => m[at + k] * x + m[at + 3 + k] * y + m[at + 6 + k] * z + m[at + 9 + k]);
}

// First `b`, then `a`.
function after(a, b) {
  const column = (k) => [0, 1, 2].map((r) => a[r] * b[k] + a[3 + r] * b[k + 1] + a[6 + r] * b[k + 2]);
  const shift = carried(a, [b[9], b[10], b[11]]);
  return [...column(0), ...column(3), ...column(6), ...shift];
}

// Right-handed turn about a unit axis (Rodrigues).
function turned(axis, angle) {
  const [x, y, z] = axis, c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
  return [
    t * x * x + c, t * x * y + s * z, t * x * z - s * y,
    t * x * y - s * z, t * y * y + c, t * y * z + s * x,
    t * x * z + s * y, t * y * z - s * x, t * z * z + c,
  ];
}

// Where a motion of the plan has come after the share `t`.
function moved(motion, t) {
  if (motion.kind === "translation") return [1, 0, 0, 0, 1, 0, 0, 0, 1, ...scale(motion.by, t)];
  const turn = turned(motion.axis, motion.angle * t);
  const point = carried([...turn, 0, 0, 0], motion.point);
  return [...turn, ...add(sub(motion.point, point), scale(motion.axis, motion.advance * t))];
}

// Column-major 4 x 4, as the card takes them.
function perspective(slope, aspect, near, far) {
  return [
    1 / (slope * aspect), 0, 0, 0, 0, 1 / slope, 0, 0,
    0, 0, (near + far) / (near - far), -1, 0, 0, (2 * near * far) / (near - far), 0,
  ];
}

function times(a, b) {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; c++)
    for (let r = 0; r < 4; r++)
      for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return out;
}

// Right, up and toward the viewer, for degrees about z from x, and above the horizon.
function frame(azimuth, elevation) {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  const [sa, ca, se, ce] = [Math.sin(a), Math.cos(a), Math.sin(e), Math.cos(e)];
  return { right: [-sa, ca, 0], up: [-se * ca, -se * sa, ce], back: [ce * ca, ce * sa, se] };
}
