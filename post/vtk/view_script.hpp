// The 3D view of report.html: plain WebGL 2, no library. It draws the data of view_data.hpp, one copy of each mesh for all bodies.
// Where bodies and walls are comes from a source: oneFrame() below, or allFrames() of report/player_script.hpp.
// Several strings, since compilers limit the length of one.
#pragma once

namespace scree {

inline constexpr const char* kViewShaders = R"JS(
"use strict";
const BODY_VERTEX = `#version 300 es
layout(location=0) in vec3 point;      // of the mesh
layout(location=1) in vec3 place;      // of the body
layout(location=2) in vec4 turn;       // unit quaternion x y z w
layout(location=3) in float size;
layout(location=4) in vec3 colour;
layout(location=5) in float row;
uniform mat4 view, projection; uniform float ball, chosen;
out vec3 seen, normal, shade, spot; flat out float number, isChosen;
vec3 rotated(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
void main() {
  spot = place + size * rotated(turn, point);
  vec4 at = view * vec4(spot, 1.0);
  seen = at.xyz; shade = colour; number = row; isChosen = row == chosen ? 1.0 : 0.0;
  normal = ball > 0.5 ? mat3(view) * rotated(turn, point) : vec3(0.0);
  gl_Position = projection * at;
}`;
const BODY_FRAGMENT = `#version 300 es
precision highp float;
in vec3 seen, normal, shade, spot; flat in float number, isChosen;
uniform float picking, ghost, part, solid;  // part 0: all, 1: the chosen body, 2: the others; solid: a back face is seen through a cut only
uniform vec4 cut;                           // normal and distance of a plane: what is beyond it is cut away
out vec4 result;
void main() {
  if (dot(cut.xyz, spot) > cut.w) discard;
  if (part == 1.0 && isChosen < 0.5 || part == 2.0 && isChosen > 0.5) discard;
  if (picking > 0.5) {
    float n = number + 1.0;
    result = vec4(mod(n, 256.0), mod(floor(n / 256.0), 256.0), floor(n / 65536.0), 255.0) / 255.0;
    return;
  }
  vec3 n = dot(normal, normal) > 0.0 ? normalize(normal) : normalize(cross(dFdx(seen), dFdy(seen)));
  if (n.z < 0.0) n = -n;
  float light = 0.30 + 0.55 * max(0.0, dot(n, normalize(vec3(-0.5, 0.7, 0.7)))) + 0.22 * max(0.0, dot(n, normalize(vec3(0.9, 0.1, 0.5))));
  vec3 c = isChosen > 0.5 ? vec3(1.0, 0.35, 0.0) : shade;
  if (solid > 0.5 && !gl_FrontFacing) light = 0.62;  // one tone, as the face of a cut has
  result = vec4(c * light, ghost);
}`;
const LINE_VERTEX = `#version 300 es
layout(location=0) in vec3 point; layout(location=1) in vec3 colour;
uniform mat4 view, projection; uniform vec3 place; uniform vec4 turn;
out vec3 shade, spot;
void main() {
  spot = place + point + 2.0 * cross(turn.xyz, cross(turn.xyz, point) + turn.w * point);
  shade = colour; gl_Position = projection * view * vec4(spot, 1.0);
}`;
const LINE_FRAGMENT = `#version 300 es
precision highp float; in vec3 shade, spot; uniform vec4 cut; out vec4 result;
void main() { if (dot(cut.xyz, spot) > cut.w) discard; result = vec4(shade, 1.0); }`;
// viridis: rises evenly in brightness, so it reads in grey and for the colour-blind
const VIRIDIS = [[.267,.005,.329],[.279,.175,.483],[.230,.322,.546],[.173,.449,.558],[.128,.567,.551],[.158,.684,.502],[.369,.789,.383],[.678,.864,.190],[.993,.906,.144]];
function viridis(s) {
  const p = Math.min(Math.max(s, 0), 1) * (VIRIDIS.length - 1), i = Math.min(Math.floor(p), VIRIDIS.length - 2), f = p - i;
  return [0, 1, 2].map(k => VIRIDIS[i][k] * (1 - f) + VIRIDIS[i + 1][k] * f);
}
const STEPS = 255, VIRIDIS_STEPS = Float32Array.from({length: 3 * (STEPS + 1)}, (_, i) => viridis(Math.floor(i / 3) / STEPS)[i % 3]);
function unpacked(text, Type) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Type(bytes.buffer);
}
const minus = (a, b) => a.map((x, i) => x - b[i]), plus = (a, b) => a.map((x, i) => x + b[i]), times = (s, a) => a.map(x => s * x);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => times(1 / Math.hypot(...a), a);
const rotated = (q, v) => { const u = q.slice(0, 3), t = plus(cross(u, v), times(q[3], v)); return plus(v, times(2, cross(u, t))); };

// Bodies of all frames, and where they are now: of a page with one frame, which is there from the start.
function oneFrame(data) {
  const now = {
    place: unpacked(data.position, Float32Array), turn: unpacked(data.orientation, Float32Array), velocity: unpacked(data.velocity, Float32Array),
    touching: unpacked(data.touching, Uint16Array), temperature: data.temperature ? unpacked(data.temperature, Float32Array) : null,
    present: new Uint8Array(data.count).fill(1), walls: unpacked(data.wallPlaces, Float64Array)
  };
  const source = {count: data.count, id: unpacked(data.id, Float64Array), shape: unpacked(data.shape, Uint16Array), material: unpacked(data.material, Uint16Array),
    scale: unpacked(data.scale, Float32Array), frames: [[data.number, data.time, data.count]], chosen: 0, contacts: data.keptContacts, now, load() {}};
  const range = of => { let low = Infinity, high = -Infinity; for (let i = 0; i < data.count; ++i) { const v = of(i); low = Math.min(low, v); high = Math.max(high, v); } return low <= high ? [low, high, false] : [0, 0, false]; };
  const speed = range(i => Math.hypot(now.velocity[3 * i], now.velocity[3 * i + 1], now.velocity[3 * i + 2]));
  source.scales = {speed: [0, speed[1], false], height: range(i => now.place[3 * i + 2] + data.centre[2])};
  if (now.temperature) source.scales.temperature = range(i => now.temperature[i]);
  return source;
}
)JS";

inline constexpr const char* kViewScript = R"JS(
function startView(canvas, panel, data, source) {
  const gl = canvas.getContext("webgl2", {alpha: false, antialias: true, preserveDrawingBuffer: true});
  if (!gl) { panel.textContent = "This browser has no WebGL 2: the view is not drawn. The pictures above show the same."; canvas.hidden = true; return null; }
  const program = (vertex, fragment) => {
    const p = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const s = gl.createShader(kind);
      gl.shaderSource(s, text); gl.compileShader(s);
      if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s));
      gl.attachShader(p, s);
    }
    gl.linkProgram(p);
    if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
    return p;
  };
  const bodyProgram = program(BODY_VERTEX, BODY_FRAGMENT), lineProgram = program(LINE_VERTEX, LINE_FRAGMENT);
  const {count, id, shape, material, now} = source;
  const speedOf = i => Math.hypot(now.velocity[3 * i], now.velocity[3 * i + 1], now.velocity[3 * i + 2]);
  const NUMBERS = {
    speed: {title: "speed", unit: "m/s", of: speedOf},
    height: {title: "height z", unit: "m", of: i => now.place[3 * i + 2] + data.centre[2]},
    temperature: {title: "temperature", unit: "K", of: i => now.temperature[i]}
  };

  // buffers: one set for each shape, with the rows of its bodies
  const buffer = (values, location, width, perBody) => {
    const b = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, b); gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(location); gl.vertexAttribPointer(location, width, gl.FLOAT, false, 0, 0);
    if (perBody) gl.vertexAttribDivisor(location, 1);
    return b;
  };
  const sets = data.shapes.map((s, k) => {
    const rows = [];
    for (let i = 0; i < count; ++i) if (shape[i] === k) rows.push(i);
    if (rows.length === 0) return null;
    const array = gl.createVertexArray(), empty = width => new Float32Array(width * rows.length);
    gl.bindVertexArray(array);
    buffer(unpacked(s.points, Float32Array), 0, 3, false);
    const moving = {place: [empty(3), 1, 3], turn: [empty(4), 2, 4], size: [empty(1), 3, 1], colour: [empty(3), 4, 3]};
    for (const m of Object.values(moving)) m.push(buffer(m[0], m[1], m[2], true));
    buffer(Float32Array.from(rows), 5, 1, true);
    const corners = unpacked(s.corners, Uint32Array), index = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index); gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return {array, rows, moving, count: corners.length, ball: s.ball && !s.coarse};
  }).filter(s => s);
  const upload = ([values, , , to]) => { gl.bindBuffer(gl.ARRAY_BUFFER, to); gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW); };
  // a body that is not there in this frame has no size
  function place() {
    for (const s of sets) {
      const {place, turn, size} = s.moving;
      s.rows.forEach((r, j) => {
        for (let c = 0; c < 3; ++c) place[0][3 * j + c] = now.place[3 * r + c];
        for (let c = 0; c < 4; ++c) turn[0][4 * j + c] = now.turn[4 * r + c];
        size[0][j] = now.present[r] ? source.scale[r] : 0;
      });
      upload(place); upload(turn); upload(size);
    }
    walls.forEach((w, k) => {
      w.turn = Array.from(now.walls.subarray(7 * k + 3, 7 * k + 7));
      w.place = minus(plus(Array.from(now.walls.subarray(7 * k, 7 * k + 3)), rotated(w.turn, w.middle)), data.centre);
    });
  }
  const lineSet = (points, colours) => {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array); buffer(points, 0, 3, false); buffer(colours, 1, 3, false); gl.bindVertexArray(null);
    return {array, count: points.length / 3};
  };
  const walls = data.walls.map(w => {
    const points = unpacked(w.edges, Float32Array), array = gl.createVertexArray(), corners = unpacked(w.corners, Uint32Array), index = gl.createBuffer();
    gl.bindVertexArray(array);
    buffer(unpacked(w.points, Float32Array), 0, 3, false);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index); gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return {array, count: corners.length, middle: w.middle, oneSided: w.oneSided, edges: lineSet(points, new Float32Array(points.length).fill(0.45))};
  });
  const linePoints = unpacked(data.lines, Float32Array), forces = unpacked(data.forces, Float32Array), lineColours = new Float32Array(linePoints.length);
  let strongest = 0;
  for (const f of forces) strongest = Math.max(strongest, f);
  forces.forEach((f, i) => { const c = viridis(f / strongest); for (let e = 0; e < 6; ++e) lineColours[6 * i + e] = c[e % 3]; });
  const lines = lineSet(linePoints, lineColours);

  const state = {chosen: -1, contacts: false, walls: "edges", colour: "shape", frame: source.chosen, cut: -1, cutAt: 0, cutSide: 1};
  const showsForces = () => state.contacts && state.frame === source.chosen;  // the page has them of this frame only
  const start = () => { const up = data.up; return {centre: [0, 0, 0], distance: 3.2 * data.radius, up, from: data.from}; };
  let camera = start();
  const legend = canvas.parentElement.querySelector(".legend");
  function paint() {
    const number = NUMBERS[state.colour], kinds = state.colour === "material" ? material : shape;
    const [low, high] = number ? source.scales[state.colour] : [0, 1], range = high > low ? high - low : 1;
    for (const s of sets) {
      const c = s.moving.colour[0];
      s.rows.forEach((r, j) => {
        if (number) {
          const step = 3 * Math.min(Math.max(Math.round(STEPS * (number.of(r) - low) / range), 0), STEPS);
          for (let k = 0; k < 3; ++k) c[3 * j + k] = VIRIDIS_STEPS[step + k];
        } else c.set(data.colours[kinds[r] % data.colours.length], 3 * j);
      });
      upload(s.moving.colour);
    }
  }
  function writeLegend() {
    legend.textContent = "";
    const entry = (colour, text) => { const e = document.createElement("span"), b = document.createElement("i"); b.style.background = colour; e.append(b, text); legend.append(e); return b; };
    const css = c => "rgb(" + c.map(x => Math.round(255 * x)).join(",") + ")", bar = "linear-gradient(90deg," + VIRIDIS.map(css).join(",") + ")";
    const number = NUMBERS[state.colour];
    if (number) {
      const [low, high, beyond] = source.scales[state.colour];
      entry(bar, number.title + " " + show(low) + " to " + show(high) + " " + number.unit + (source.frames.length > 1 ? " in all frames" : "") +
        (beyond ? "; bodies that have left are beyond" : "")).className = "scale";
    } else {
      const ofMaterial = state.colour === "material", used = new Set(ofMaterial ? material : shape);
      (ofMaterial ? data.materials : data.shapes.map(s => s.name)).forEach((n, k) => { if (used.has(k)) entry(css(data.colours[k % data.colours.length]), n); });
    }
    if (showsForces()) entry(bar, "normal force up to " + show(strongest) + " N").className = "scale";
    if (data.shapes.some((s, k) => s.coarse && shape.includes(k))) entry("transparent", "shapes are drawn coarser than they are");
    if (state.walls !== "hidden" && data.walls.some(w => w.coarse)) entry("transparent", "walls are drawn coarser than they are");
  }
  function matrices() {
    const z = camera.from, x = unit(cross(camera.up, z)), y = cross(z, x), eye = plus(camera.centre, times(camera.distance, z));
    const view = [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
    const aspect = canvas.width / canvas.height, f = 1 / Math.tan(Math.PI / 12) / (aspect < 1.2 ? 1.2 / aspect : 1);
    const far = camera.distance + 6 * data.radius, near = Math.max(far / 4000, camera.distance - 4 * data.radius);
    return {x, y, z, eye, view, projection: [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]};
  }
  // plane of the cut: relative to the middle of the view, as all that is drawn
  function cutPlane() {
    if (state.cut < 0) return [0, 0, 0, 1];
    const plane = [0, 0, 0, state.cutSide * (state.cutAt - data.centre[state.cut])];
    plane[state.cut] = state.cutSide;
    return plane;
  }
  function useBodies(m, picking, part, ghost, solid) {
    gl.useProgram(bodyProgram);
    const at = name => gl.getUniformLocation(bodyProgram, name);
    gl.uniformMatrix4fv(at("view"), false, m.view); gl.uniformMatrix4fv(at("projection"), false, m.projection); gl.uniform4fv(at("cut"), cutPlane());
    gl.uniform1f(at("picking"), picking ? 1 : 0); gl.uniform1f(at("chosen"), state.chosen < 0 ? -9 : state.chosen);
    gl.uniform1f(at("part"), part); gl.uniform1f(at("ghost"), ghost); gl.uniform1f(at("solid"), solid ? 1 : 0);
    return at;
  }
  function bodies(m, picking, part, ghost) {
    const at = useBodies(m, picking, part, ghost, state.cut >= 0);
    for (const s of sets) {
      gl.bindVertexArray(s.array); gl.uniform1f(at("ball"), s.ball ? 1 : 0);
      gl.drawElementsInstanced(gl.TRIANGLES, s.count, gl.UNSIGNED_INT, 0, s.rows.length);
    }
  }
  // a wall is drawn as a body with the number -1, which picks nothing
  function surfaces(m, picking, alpha) {
    gl.uniform1f(useBodies(m, picking, 0, alpha, false)("ball"), 0);
    gl.cullFace(gl.BACK);
    for (const w of walls) {
      gl.bindVertexArray(w.array);
      gl.vertexAttrib3fv(1, w.place); gl.vertexAttrib4fv(2, w.turn); gl.vertexAttrib1f(3, 1); gl.vertexAttrib3f(4, 0.72, 0.77, 0.83); gl.vertexAttrib1f(5, -1);
      if (w.oneSided && alpha === 1) gl.enable(gl.CULL_FACE);
      gl.drawElements(gl.TRIANGLES, w.count, gl.UNSIGNED_INT, 0);
      gl.disable(gl.CULL_FACE);
    }
  }
  function strokes(m, set, place, turn) {
    gl.useProgram(lineProgram);
    const at = name => gl.getUniformLocation(lineProgram, name);
    gl.uniformMatrix4fv(at("view"), false, m.view); gl.uniformMatrix4fv(at("projection"), false, m.projection);
    gl.uniform4fv(at("cut"), cutPlane()); gl.uniform3fv(at("place"), place); gl.uniform4fv(at("turn"), turn);
    gl.bindVertexArray(set.array); gl.drawArrays(gl.LINES, 0, set.count);
  }
  // what hides nothing: over what is drawn already
  function translucent(action) {
    gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA); gl.depthMask(false);
    action();
    gl.disable(gl.BLEND); gl.depthMask(true);
  }
  function draw() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2), w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
    if (w > 0 && h > 0 && (canvas.width !== w || canvas.height !== h)) { canvas.width = w; canvas.height = h; }
    const m = matrices();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.957, 0.965, 0.976, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT); gl.enable(gl.DEPTH_TEST);
    if (state.walls === "opaque") surfaces(m, false, 1);
    if (state.walls !== "hidden") for (const wall of walls) strokes(m, wall.edges, wall.place, wall.turn);
    if (showsForces()) {
      // the chosen body as it is, the others as ghosts, the forces among them
      bodies(m, false, 1, 1);
      translucent(() => bodies(m, false, 2, 0.07));
      strokes(m, lines, [0, 0, 0], [0, 0, 0, 1]);
    } else bodies(m, false, 0, 1);
    if (state.walls === "translucent") translucent(() => surfaces(m, false, 0.22));
  }
  let due = false;
  const redraw = () => { if (!due) { due = true; requestAnimationFrame(() => { due = false; draw(); }); } };

  // the body at a point of the canvas [CSS pixels]: drawn with its number as colour into a hidden picture
  function bodyAt(px, py) {
    const target = gl.createFramebuffer(), colour = gl.createRenderbuffer(), depth = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    for (const [b, format, to] of [[colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT16, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, b); gl.renderbufferStorage(gl.RENDERBUFFER, format, canvas.width, canvas.height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, to, gl.RENDERBUFFER, b);
    }
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT); gl.enable(gl.DEPTH_TEST);
    if (state.walls === "opaque") surfaces(matrices(), true, 1);
    bodies(matrices(), true, 0, 1);
    const pixel = new Uint8Array(4), scale = canvas.width / canvas.clientWidth;
    gl.readPixels(Math.floor(px * scale), canvas.height - 1 - Math.floor(py * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(target); gl.deleteRenderbuffer(colour); gl.deleteRenderbuffer(depth);
    return pixel[3] === 0 ? -1 : pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1;
  }
  const show = x => String(Number(Number(x).toPrecision(4)));
  const metres = (values, i) => [0, 1, 2].map(c => show(values[3 * i + c])).join(", ");
  const say = text => { if (panel.textContent !== text) panel.textContent = text; };
  function choose(row) {
    state.chosen = row;
    if (row < 0) say("Pick a body to read about it.");
    else if (!now.present[row]) say("Body " + id[row] + ": " + data.shapes[shape[row]].name + ", not there at t = " + show(source.frames[state.frame][1]) + " s.");
    else {
      const x = [0, 1, 2].map(c => show(now.place[3 * row + c] + data.centre[c])).join(", ");
      say("Body " + id[row] + ": " + data.shapes[shape[row]].name + " of " + data.materials[material[row]] + ", equivalent diameter " +
        show(source.scale[row] * data.shapes[shape[row]].diameter) + " m, at (" + x + ") m, velocity (" + metres(now.velocity, row) + ") m/s, speed " +
        show(speedOf(row)) + " m/s" + (now.temperature ? ", temperature " + show(now.temperature[row]) + " K" : "") +
        (source.contacts ? ", contacts: " + now.touching[row] : ""));
    }
    redraw();
  }

  // turn, move, zoom; one finger or button turns, two fingers or shift move and zoom
  function turnBy(dx, dy) {
    const m = matrices(), spin = (v, axis, a) => plus(plus(times(Math.cos(a), v), times(Math.sin(a), cross(axis, v))), times(dot(axis, v) * (1 - Math.cos(a)), axis));
    const about = spin(camera.from, camera.up, -dx), next = spin(about, unit(cross(camera.up, about)), -dy);
    if (Math.abs(dot(next, camera.up)) < 0.999) camera.from = unit(next); else camera.from = unit(about);
    redraw();
  }
  function moveBy(dx, dy) { const m = matrices(), s = camera.distance * 0.55 / canvas.clientHeight; camera.centre = plus(camera.centre, plus(times(-dx * s, m.x), times(dy * s, m.y))); redraw(); }
  function zoomBy(factor) { camera.distance = Math.min(Math.max(camera.distance * factor, 0.02 * data.radius), 40 * data.radius); redraw(); }
  const pointers = new Map();
  let moved = 0;
  canvas.addEventListener("pointerdown", e => { canvas.setPointerCapture(e.pointerId); pointers.set(e.pointerId, [e.clientX, e.clientY]); moved = pointers.size > 1 ? 99 : 0; });
  canvas.addEventListener("pointermove", e => {
    const old = pointers.get(e.pointerId);
    if (!old) return;
    const dx = e.clientX - old[0], dy = e.clientY - old[1];
    moved += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 1) { if (e.shiftKey || e.buttons & 6) moveBy(dx, dy); else turnBy(dx * 0.008, dy * 0.008); }
    else {
      const other = [...pointers.entries()].find(([k]) => k !== e.pointerId)[1];
      const before = Math.hypot(old[0] - other[0], old[1] - other[1]), after = Math.hypot(e.clientX - other[0], e.clientY - other[1]);
      if (before > 0 && after > 0) zoomBy(before / after);
      moveBy(dx / 2, dy / 2);
    }
    pointers.set(e.pointerId, [e.clientX, e.clientY]);
  });
  const up = e => { if (pointers.delete(e.pointerId) && e.type === "pointerup" && moved < 6) { const r = canvas.getBoundingClientRect(); choose(bodyAt(e.clientX - r.left, e.clientY - r.top)); } };
  canvas.addEventListener("pointerup", up); canvas.addEventListener("pointercancel", up);
  // a page is scrolled past the view with the wheel; Ctrl and wheel, or the buttons, zoom, and so does the wheel once the view has the focus
  canvas.addEventListener("wheel", e => { if (!e.ctrlKey && document.activeElement !== canvas) return; e.preventDefault(); zoomBy(Math.exp(0.0015 * e.deltaY)); }, {passive: false});
  canvas.addEventListener("contextmenu", e => e.preventDefault());
  canvas.addEventListener("keydown", e => {
    const act = {ArrowLeft: () => turnBy(-0.1, 0), ArrowRight: () => turnBy(0.1, 0), ArrowUp: () => turnBy(0, -0.1), ArrowDown: () => turnBy(0, 0.1), "+": () => zoomBy(0.9), "-": () => zoomBy(1.1)}[e.key];
    if (act) { e.preventDefault(); act(); }
  });
  const tools = canvas.parentElement.querySelector(".tools");
  const tool = name => tools.querySelector("[name=" + name + "]");
  tool("colour").addEventListener("change", e => { state.colour = e.target.value; paint(); writeLegend(); redraw(); });
  tool("contacts").addEventListener("change", e => { state.contacts = e.target.checked; writeLegend(); redraw(); });
  tool("walls").addEventListener("change", e => { state.walls = e.target.value; writeLegend(); redraw(); });
  const cutTools = tools.querySelector(".cut-tools"), cutAt = tool("cut-at");
  function moveCut() {
    const [low, high] = [data.room[0][state.cut], data.room[1][state.cut]];
    const digits = Math.min(Math.max(3 - Math.floor(Math.log10(high - low)), 0), 20);  // a step of the slider, not the rounding of its middle
    state.cutAt = low + (high - low) * cutAt.value / cutAt.max;
    tools.querySelector("output.cut").textContent = "xyz"[state.cut] + " = " + (Number(state.cutAt.toFixed(digits)) + 0) + " m";
    redraw();
  }
  tool("cut").addEventListener("change", e => {
    state.cut = ["x", "y", "z"].indexOf(e.target.value);
    cutTools.hidden = state.cut < 0;
    if (state.cut < 0) { redraw(); return; }
    state.cutSide = camera.from[state.cut] >= 0 ? 1 : -1;  // the side that hides the rest
    cutAt.value = cutAt.max / 2;
    moveCut();
  });
  cutAt.addEventListener("input", moveCut);
  tool("cut-side").addEventListener("click", () => { state.cutSide = -state.cutSide; redraw(); });
  function showFrame(k) {
    source.load(k);
    state.frame = k;
    place();
    if (NUMBERS[state.colour]) paint();
    const forces = tool("contacts"), had = forces.disabled;
    forces.disabled = lines.count === 0 || k !== source.chosen;
    if (had !== forces.disabled) writeLegend();
    choose(state.chosen);
  }
  tool("nearer").addEventListener("click", () => zoomBy(0.8));
  tool("further").addEventListener("click", () => zoomBy(1.25));
  tool("reset").addEventListener("click", () => { camera = start(); choose(-1); });
  new ResizeObserver(redraw).observe(canvas);
  window.addEventListener("beforeprint", draw);
  paint(); writeLegend(); showFrame(source.chosen); draw();

  // for the player; for tests: what share of the canvas bodies cover, and where on the page one of them is seen
  return {
    showFrame, frames: source.frames,
    covered() {
      draw();
      const all = new Uint8Array(4 * canvas.width * canvas.height);
      gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, all);
      let other = 0;
      for (let i = 0; i < all.length; i += 4) if (Math.abs(all[i] - 244) + Math.abs(all[i + 1] - 246) + Math.abs(all[i + 2] - 249) > 6) ++other;
      return other / (canvas.width * canvas.height);
    },
    visible() {
      const r = canvas.getBoundingClientRect();
      for (let y = 0.3; y < 0.9; y += 0.02) {
        for (let x = 0.3; x < 0.7; x += 0.02) {
          const row = bodyAt(x * r.width, y * r.height);
          if (row >= 0) { draw(); return {id: id[row], x: r.left + x * r.width, y: r.top + y * r.height}; }
        }
      }
      return null;
    },
    poses() {
      const list = [];
      for (let i = 0; i < count; ++i) {
        if (now.present[i]) list.push([id[i], ...[0, 1, 2].map(c => now.place[3 * i + c] + data.centre[c]), ...now.turn.subarray(4 * i, 4 * i + 4), ...now.velocity.subarray(3 * i, 3 * i + 3)]);
      }
      return list;
    },
    wallPlaces: () => Array.from(now.walls),
    state, cameraFrom: () => camera.from, distance: () => camera.distance
  };
}
const dataOf = name => JSON.parse(document.getElementById(name).textContent);
)JS";

inline constexpr const char* kViewStart = R"JS(
{
  const data = dataOf("view-data");
  window.screeView = startView(document.getElementById("view-canvas"), document.getElementById("view-panel"), data, oneFrame(data));
}
)JS";

}  // namespace scree
