// The graphics card: programs, buffers, one picture of what `show` decided. Parts that share a shape are one call.
const HEAD = "#version 300 es\nprecision highp float;\n";
const PLACED = `
layout(location=0) in vec3 p; layout(location=1) in vec3 n;
layout(location=2) in vec3 cx; layout(location=3) in vec3 cy; layout(location=4) in vec3 cz; layout(location=5) in vec3 shift;
layout(location=6) in vec4 tint;
uniform mat4 see;
out vec3 world; out vec3 normal; flat out vec4 colour;
void main() {
  mat3 turn = mat3(cx, cy, cz);
  world = turn * p + shift; normal = turn * n; colour = tint;
  gl_Position = see * vec4(world, 1.0);
}`;
// What both fragments begin with: the section takes away what lies before it.
const CUT = `
in vec3 world; in vec3 normal; flat in vec4 colour;
uniform vec4 cut; uniform vec3 eye; uniform vec3 key; uniform int mode;
out vec4 seen;
void main() {
  if (dot(cut.xyz, world) > cut.w) discard;`;
const SHADE = `${CUT}
  if (mode == 1) { seen = colour; return; }
  vec3 base = pow(colour.rgb, vec3(2.2));
  vec3 n = normalize(normal), v = normalize(eye - world);
  if (!gl_FrontFacing) {
    float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0));
    seen = vec4(pow(base * mix(0.62, 0.8, stripe), vec3(1.0 / 2.2)), colour.a);
    return;
  }
  float sky = 0.5 + 0.5 * n.z;
  vec3 light = mix(vec3(0.34, 0.33, 0.32), vec3(0.62, 0.63, 0.66), sky) + vec3(0.50, 0.48, 0.44) * max(dot(n, key), 0.0);
  float rim = 1.0 - max(dot(n, v), 0.0);
  light *= 1.0 - 0.45 * rim * rim * rim;
  float alpha = colour.a < 1.0 ? mix(colour.a, min(1.0, colour.a + 0.5), rim * rim) : 1.0;
  seen = vec4(pow(min(base * light, vec3(1.0)), vec3(1.0 / 2.2)), alpha);
}`;
const LINE = `${CUT}
  seen = vec4(0.1, 0.1, 0.125, 0.75 * min(1.0, colour.a * 1.5));
}`;

// Floats of one part in the buffer of instances: its pose and its tint.
const ROW = 16;

function stage(canvas) {
  const gl = canvas.getContext("webgl2", { antialias: false, alpha: true, preserveDrawingBuffer: true });
  if (!gl) return null;
  const compiled = (kind, text) => {
    const s = gl.createShader(kind);
    gl.shaderSource(s, HEAD + text);
    gl.compileShader(s);
    if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s));
    return s;
  };
  const program = (fragment) => {
    const p = gl.createProgram();
    gl.attachShader(p, compiled(gl.VERTEX_SHADER, PLACED));
    gl.attachShader(p, compiled(gl.FRAGMENT_SHADER, fragment));
    gl.linkProgram(p);
    if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
    const at = (name) => gl.getUniformLocation(p, name);
    return { p, see: at("see"), cut: at("cut"), eye: at("eye"), key: at("key"), mode: at("mode") };
  };
  const shade = program(SHADE), line = program(LINE);
  const instances = gl.createBuffer();

  const filled = (kind, data) => {
    const b = gl.createBuffer();
    gl.bindBuffer(kind, b);
    gl.bufferData(kind, data, gl.STATIC_DRAW);
    return b;
  };
  const triple = (at, buffer, divisor, stride, offset, size = 3) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(at, divisor);
  };
  // Where the instances of the next call start in their buffer.
  const from = (first) => {
    for (let k = 0; k < 4; k++) triple(2 + k, instances, 1, 4 * ROW, 4 * (ROW * first + 3 * k));
    triple(6, instances, 1, 4 * ROW, 4 * (ROW * first + 12), 4);
  };
  const solid = (shape) => {
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    triple(0, filled(gl.ARRAY_BUFFER, shape.positions), 0, 12, 0);
    triple(1, filled(gl.ARRAY_BUFFER, shape.normals), 0, 12, 0);
    filled(gl.ELEMENT_ARRAY_BUFFER, shape.corners);
    return { vao, count: shape.corners.length };
  };
  const lines = (shape) => {
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    triple(0, filled(gl.ARRAY_BUFFER, shape.creases), 0, 12, 0);
    return { vao, count: shape.creases.length / 3 };
  };

  // Buffers of a shape; the coarse copy is made when it is first wanted.
  const load = (shape) => {
    const whole = { fine: solid(shape), lines: lines(shape) };
    return {
      draw(runs, { rough, what, cells }) {
        if (rough && !whole.rough) whole.rough = solid(coarse(shape, cells));
        const part = what === "lines" ? whole.lines : rough ? whole.rough : whole.fine;
        gl.bindVertexArray(part.vao);
        for (const { first, count } of runs) {
          from(first);
          if (what === "lines") gl.drawArraysInstanced(gl.LINES, 0, part.count, count);
          else gl.drawElementsInstanced(gl.TRIANGLES, part.count, gl.UNSIGNED_INT, 0, count);
        }
      },
    };
  };

  const use = (program, look) => {
    gl.useProgram(program.p);
    gl.uniformMatrix4fv(program.see, false, look.see);
    gl.uniform4fv(program.cut, look.cut);
    gl.uniform3fv(program.eye, look.eye);
    gl.uniform3fv(program.key, look.key);
    gl.uniform1i(program.mode, look.flat ? 1 : 0);
  };

  // Edges are smoothed when the picture rests: that is most of the work where the processor draws.
  const smooth = { buffer: gl.createFramebuffer(), colour: gl.createRenderbuffer(), depth: gl.createRenderbuffer(), size: "" };
  const SMOOTH = Math.min(4, gl.getParameter(gl.MAX_SAMPLES));
  const smoothed = ({ width, height }) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, smooth.buffer);
    if (smooth.size === width + "x" + height) return;
    smooth.size = width + "x" + height;
    for (const [box, format, place] of [[smooth.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [smooth.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, box);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, SMOOTH, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, box);
    }
  };
  const picture = (rows, items, look) => {
    const fine = look.smooth && SMOOTH > 1;
    if (fine) smoothed(look);
    painted(rows, items, look);
    if (!fine) return;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, smooth.buffer);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, look.width, look.height, 0, 0, look.width, look.height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  };

  // `items`: buffers with the runs of instances that are solid and those that are seen through.
  const painted = (rows, items, look) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, instances);
    gl.bufferData(gl.ARRAY_BUFFER, rows, gl.DYNAMIC_DRAW);
    gl.viewport(0, 0, look.width, look.height);
    gl.clearColor(0, 0, 0, 0);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    use(shade, look);
    const faces = (pick, side, offset) => {
      gl.cullFace(side);
      gl.polygonOffset(offset, offset);
      for (const item of items) item.mesh.draw(item[pick], look);
    };
    gl.disable(gl.BLEND);
    faces("solid", gl.BACK, 2);
    // The walls seen from inside, through the cut, stand for the cut face; they win over a neighbour's touching face.
    if (look.sectioned) faces("solid", gl.FRONT, -2);
    if (look.flat) return;
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    if (!look.rough) {
      use(line, look);
      for (const item of items) if (item.lined) item.mesh.draw(item.solid, { ...look, what: "lines" });
      use(shade, look);
    }
    gl.depthMask(false);
    faces("ghost", gl.BACK, 0);
    gl.depthMask(true);
  };

  // Numbers of the parts under a rectangle of pixels (lower left corner), drawn flat into a buffer of their own.
  const numbers = (rows, items, look) => {
    const { width, height } = look, target = gl.createFramebuffer(), boxes = [gl.createRenderbuffer(), gl.createRenderbuffer()];
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    const attach = (box, format, place) => {
      gl.bindRenderbuffer(gl.RENDERBUFFER, box);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, box);
    };
    attach(boxes[0], gl.RGBA8, gl.COLOR_ATTACHMENT0);
    attach(boxes[1], gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT);
    painted(rows, items, { ...look, flat: true });
    const out = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    boxes.forEach((b) => gl.deleteRenderbuffer(b));
    gl.deleteFramebuffer(target);
    return out;
  };

  const finish = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  return { load, picture, numbers, finish, lost: () => gl.isContextLost() };
}
