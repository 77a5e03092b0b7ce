// What came with the page: buffers out of base64, and a coarse copy of each shape for pictures that move.
function bytes(text) {
  const raw = atob(text), out = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) out[k] = raw.charCodeAt(k);
  return out.buffer;
}
const floats = (text) => new Float32Array(bytes(text));
const whole = (text) => new Uint32Array(bytes(text));

// Cells across a shape's longest side in its coarse copy: about four pixels each where the parts share a picture 1,000
// pixels wide, so that it hardly shows while things move.
const cellsFor = (count) => clamp(Math.round(250 / Math.sqrt(count)), 5, 24);

// Corners of one cell (and, for light, of one side of space) become one; triangles that lose a corner go.
function coarse(shape, cells) {
  const { positions, normals, corners } = shape, size = (2 * shape.radius) / cells || 1;
  const places = new Map(), index = new Map(), p = [], n = [], t = [];
  const keyOf = (k) => [0, 1, 2].map((d) => Math.floor(positions[3 * k + d] / size)).join();
  const corner = (k) => {
    const cell = keyOf(k);
    if (!places.has(cell)) places.set(cell, k);
    const side = [0, 1, 2].map((d) => Math.round(normals[3 * k + d] * 1.5)).join();
    const key = cell + ";" + side;
    if (!index.has(key)) {
      const at = places.get(cell);
      index.set(key, p.length / 3);
      for (let d = 0; d < 3; d++) p.push(positions[3 * at + d]), n.push(normals[3 * k + d]);
    }
    return [index.get(key), cell];
  };
  for (let k = 0; k < corners.length; k += 3) {
    const [a, b, c] = [corner(corners[k]), corner(corners[k + 1]), corner(corners[k + 2])];
    if (a[1] !== b[1] && b[1] !== c[1] && c[1] !== a[1]) t.push(a[0], b[0], c[0]);
  }
  return { positions: new Float32Array(p), normals: new Float32Array(n), corners: new Uint32Array(t) };
}

function shapeOf(raw) {
  return {
    ...raw,
    positions: floats(raw.positions),
    normals: floats(raw.normals),
    corners: whole(raw.corners),
    creases: floats(raw.creases),
  };
}

function exhibitOf(raw) {
  const shapes = raw.shapes.map(shapeOf), shape_of = whole(raw.shape_of), packed = new Float64Array(bytes(raw.poses));
  const poses = Array.from(shape_of, (_, p) => Array.from(packed.subarray(12 * p, 12 * p + 12)));
  const touch = raw.touch === null ? null : new Map();
  if (touch) {
    const list = whole(raw.touch);
    for (let k = 0; k < list.length; k += 3) {
      if (!touch.has(list[k])) touch.set(list[k], []);
      touch.get(list[k]).push([list[k + 1], list[k + 2]]);
    }
  }
  const signs = raw.signs.map((s) => ({ ...s, shape: shapeOf(s.shape) }));
  const triangles = shape_of.reduce((sum, s) => sum + shapes[s].corners.length / 3, 0);
  return { ...raw, shapes, shape_of, poses, touch, signs, count: shape_of.length, triangles };
}

// Poses after a number of steps, kept at the last whole one: a plan of 2,000 steps is not replayed for each picture.
function player(exhibit, plan) {
  const steps = plan ? plan.steps : [];
  const start = () => ({ done: 0, at: Array.from({ length: exhibit.count }, () => IDENTITY) });
  let kept = start();
  let table = { step: -1, on: new Uint8Array(exhibit.count).fill(1) };
  const apply = (list, step, share) => {
    for (const { parts, motion } of step.movers) {
      const m = moved(motion, share);
      for (const p of parts) list[p] = after(m, list[p]);
    }
  };
  return {
    steps,
    // Displacement of each part; the list must not be changed.
    at(done) {
      const floor = Math.min(Math.floor(done), steps.length);
      if (floor < kept.done) kept = start();
      for (; kept.done < floor; kept.done++) apply(kept.at, steps[kept.done], 1);
      if (floor >= steps.length || done === floor) return kept.at;
      const list = kept.at.slice();
      apply(list, steps[floor], done - floor);
      return list;
    },
    // 1 for each part on the table while this step is shown; -1: before the first.
    table(step) {
      if (step < table.step) table = { step: -1, on: new Uint8Array(exhibit.count).fill(1) };
      for (; table.step < step; ) {
        const { on, off } = steps[++table.step];
        on.forEach((p) => (table.on[p] = 1));
        off.forEach((p) => (table.on[p] = 0));
      }
      return table.on;
    },
  };
}
