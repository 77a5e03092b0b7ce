// What is to be seen: which exhibit and plan, how far, which colours, from where; makes the rows that the card draws.
// Half the opening angle of the view over its height: 12 degrees, as in the still pictures.
const SLOPE = Math.tan((12 * Math.PI) / 180);
// How far parts move apart in the exploded view, in their distance from the middle: as in the still pictures.
const APART = [1.3, 1.3, 0.6];
const FAINT = 0.14;
const PALE = [196, 196, 192];
const PICKED = [230, 159, 0], STOPS = [22, 92, 152], TOUCHES = [166, 210, 236];
const DIRECTIONS = ["+x", "−x", "+y", "−y", "+z", "−z"];
// More triangles than this are drawn from the coarse copies while the picture moves: a phone draws so many in time.
const MOST_TRIANGLES = 150000;
// More than this, and triangles are finer than pixels: their edges are not smoothed, which a processor takes seconds for.
const MOST_SMOOTHED = 1000000;

function show(exhibits, stage, canvas) {
  const loaded = new Map();
  const state = {
    exhibit: 0, plan: 0, done: 0, scheme: 0, signs: false, left: "faint", explode: 0, picked: -1, direction: 4,
    section: { axis: -1, at: 0, flip: false }, view: { azimuth: -62, elevation: 38, zoom: 1, pan: [0, 0] }, moving: false,
  };
  let exhibit, play, meshes, signs, order, middles;

  const buffers = (shape) => {
    if (!loaded.has(shape)) loaded.set(shape, stage.load(shape));
    return loaded.get(shape);
  };
  const choosePlan = (k) => {
    state.plan = k;
    state.done = 0;
    play = player(exhibit, exhibit.plans[k]);
  };
  const choose = (k) => {
    state.exhibit = k;
    exhibit = exhibits[k];
    meshes = exhibit.shapes.map(buffers);
    signs = exhibit.signs.map((s) => buffers(s.shape));
    order = Array.from({ length: exhibit.count }, (_, p) => p).sort((a, b) => exhibit.shape_of[a] - exhibit.shape_of[b] || a - b);
    middles = order.slice();
    for (let p = 0; p < exhibit.count; p++) middles[p] = exhibit.poses[p].slice(9);
    Object.assign(state, { scheme: 0, picked: -1, explode: 0, signs: false });
    Object.assign(state.view, { zoom: 1, pan: [0, 0] });
    state.section.axis = -1;
    choosePlan(Math.max(0, exhibit.plans.findIndex((p) => p.steps.length)));
  };

  // The step that is being shown, or -1.
  const step = () => (state.done > 0 ? Math.ceil(state.done) - 1 : -1);

  // Blocking has no list of colours: it is made for the part that is picked.
  const blocking = () => exhibit.touch && state.scheme === exhibit.schemes.length;
  const colours = () => {
    if (!blocking()) return exhibit.schemes[state.scheme].colours;
    const list = Array.from({ length: exhibit.count }, () => PALE);
    if (state.picked < 0) return list;
    for (const [other, mask] of exhibit.touch.get(state.picked) || []) list[other] = (mask >> state.direction) & 1 ? STOPS : TOUCHES;
    list[state.picked] = PICKED;
    return list;
  };
  const legend = () => {
    if (!blocking()) return exhibit.schemes[state.scheme].legend;
    if (state.picked < 0) return [[PALE, "choose a part: click on it, or in the list"]];
    const list = exhibit.touch.get(state.picked) || [];
    const stops = list.filter(([, mask]) => (mask >> state.direction) & 1).map(([p]) => exhibit.ids[p]);
    const named = stops.slice(0, 6).join(", ") + (stops.length > 6 ? " and " + (stops.length - 6) + " more" : "");
    return [
      [PICKED, exhibit.ids[state.picked] + ", to move along " + DIRECTIONS[state.direction]],
      [STOPS, stops.length ? "stopped at once by " + named : "stopped by none that it touches"],
      [TOUCHES, "touches, does not stop it: " + (list.length - stops.length)],
    ];
  };

  const spread = (p) => {
    const m = middles[p];
    return [0, 1, 2].map((d) => m[d] * APART[d] * state.explode);
  };

  // Rows in the order of shapes, solid before seen-through; runs of both for each shape.
  const rows = (tintOf) => {
    const poses = play.at(state.done), on = play.table(step());
    const extra = state.signs ? signs.length : 0;
    const out = new Float32Array(ROW * (exhibit.count + extra));
    const items = meshes.map((mesh) => ({ mesh, lined: true, solid: [], ghost: [] }));
    const inside = state.signs && exhibit.signs.some((s) => s.inside);
    const ghostly = (p) => !on[p] || (inside && state.picked !== p);
    let row = 0;
    const put = (p, alpha) => {
      const pose = after(poses[p], exhibit.poses[p]);
      const shift = spread(p);
      out.set(pose, ROW * row);
      for (let d = 0; d < 3; d++) out[ROW * row + 9 + d] += shift[d];
      out.set(tintOf(p, alpha), ROW * row + 12);
      row++;
    };
    for (let k = 0; k < order.length; ) {
      const shape = exhibit.shape_of[order[k]];
      const mine = [];
      for (; k < order.length && exhibit.shape_of[order[k]] === shape; k++) mine.push(order[k]);
      const solid = mine.filter((p) => !ghostly(p)), ghost = mine.filter((p) => ghostly(p) && (on[p] || state.left === "faint"));
      if (solid.length) items[shape].solid.push({ first: row, count: solid.length });
      solid.forEach((p) => put(p, 1));
      if (ghost.length) items[shape].ghost.push({ first: row, count: ghost.length });
      ghost.forEach((p) => put(p, FAINT));
    }
    for (let k = 0; k < extra; k++) {
      out.set(IDENTITY, ROW * row);
      const { centre } = exhibit.signs[k].shape;
      for (let d = 0; d < 3; d++) out[ROW * row + 9 + d] = centre[d];
      out.set([...exhibit.signs[k].colour.map((c) => c / 255), 1], ROW * row + 12);
      items.push({ mesh: signs[k], lined: false, solid: [{ first: row++, count: 1 }], ghost: [] });
    }
    return { out, items, poses, on };
  };

  // Everything on the table stays in view: how far it reaches from the middle, across and up.
  const reach = (poses, on) => {
    let across = 0, high = 0;
    for (let p = 0; p < exhibit.count; p++) {
      if (!on[p]) continue;
      const at = add(carried(poses[p], middles[p]), spread(p)), r = exhibit.shapes[exhibit.shape_of[p]].radius;
      across = Math.max(across, Math.hypot(at[0], at[1]) + r);
      high = Math.max(high, Math.abs(at[2]) + r);
    }
    // Balls about parts are larger than the parts: in place, the ball about all is known.
    if (state.done === 0 && state.explode === 0) across = Math.min(across, exhibit.radius), high = Math.min(high, exhibit.radius);
    return { across: across || 1, high: high || 1 };
  };

  const cut = () => {
    const { axis, at, flip } = state.section;
    if (axis < 0) return [0, 0, 0, 1];
    const normal = [0, 0, 0];
    normal[axis] = flip ? -1 : 1;
    return [...normal, at * exhibit.radius * normal[axis]];
  };

  const look = (poses, on) => {
    const { azimuth, elevation, zoom, pan } = state.view, { right, up, back } = frame(azimuth, elevation);
    const width = canvas.width, height = canvas.height, aspect = width / height;
    const { across, high } = reach(poses, on), radius = Math.hypot(across, high);
    // What is seen of a drum of that size: its width, and its height on the picture, half of them; the near rim looms.
    const e = (elevation * Math.PI) / 180, tall = across * Math.abs(Math.sin(e)) + high * Math.cos(e);
    const distance = (Math.max(across / (SLOPE * aspect), tall / SLOPE) + 0.25 * across * Math.cos(e)) / zoom;
    const target = add(scale(right, pan[0] * exhibit.radius), scale(up, pan[1] * exhibit.radius));
    const eye = add(target, scale(back, distance));
    const far = distance + radius * 2 + norm(target), near = Math.max(distance - radius * 2 - norm(target), far / 2000);
    const seen = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
    const key = add(add(scale(right, -0.55), scale(up, 0.65)), scale(back, 0.55));
    return {
      see: times(perspective(SLOPE, aspect, near, far), seen), eye, key: scale(key, 1 / norm(key)), cut: cut(),
      sectioned: state.section.axis >= 0, rough: state.moving && exhibit.triangles > MOST_TRIANGLES, smooth: !state.moving && exhibit.triangles <= MOST_SMOOTHED, cells: cellsFor(exhibit.count), width, height,
    };
  };

  const draw = () => {
    const list = colours();
    const made = rows((p, alpha) => [...list[p].map((c) => c / 255), alpha]);
    stage.picture(made.out, made.items, look(made.poses, made.on));
  };

  // Numbers of the parts seen, one for each pixel from the lower left; -1 where there is none.
  const seen = () => {
    const made = rows((p) => [((p + 1) & 255) / 255, (((p + 1) >> 8) & 255) / 255, (((p + 1) >> 16) & 255) / 255, 1]);
    const items = made.items.filter((i) => i.lined);
    const raw = stage.numbers(made.out, items, look(made.poses, made.on));
    return (k) => (raw[4 * k] | (raw[4 * k + 1] << 8) | (raw[4 * k + 2] << 16)) - 1;
  };

  // The part at a point of the canvas, in its pixels from the upper left.
  const partAt = (x, y) => {
    const column = clamp(Math.floor(x), 0, canvas.width - 1), row = clamp(canvas.height - 1 - Math.floor(y), 0, canvas.height - 1);
    return seen()(row * canvas.width + column);
  };

  // Displacement of a part from where it stands assembled, in world coordinates: twelve numbers.
  const pose = (id) => {
    const p = exhibit.ids.indexOf(id);
    if (p < 0) return null;
    const d = play.at(state.done)[p].slice(), c = exhibit.middle;
    const turnedMiddle = carried([...d.slice(0, 9), 0, 0, 0], c);
    for (let k = 0; k < 3; k++) d[9 + k] += c[k] - turnedMiddle[k];
    return d;
  };

  // Share of the pixels that show each part, of those that show any.
  const shares = () => {
    const number = seen(), count = new Map();
    let all = 0;
    for (let k = 0; k < canvas.width * canvas.height; k++) {
      const p = number(k);
      if (p >= 0) all++, count.set(p, (count.get(p) || 0) + 1);
    }
    return Object.fromEntries([...count].map(([p, n]) => [exhibit.ids[p], n / all]));
  };

  // How the picture is looked at now: clip coordinates, eye and light of the scene about its middle.
  const camera = () => {
    const { see, eye, key, width, height } = look(play.at(state.done), play.table(step()));
    return { see: Array.from(see), eye, key, width, height };
  };

  choose(0);
  return {
    camera, state, choose, choosePlan, step, legend, blocking, draw, partAt, pose, shares,
    exhibit: () => exhibit, steps: () => play.steps, finish: () => stage.finish(),
  };
}
