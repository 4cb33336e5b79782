// The 3D view of report.html: plain WebGL 2, no library. It draws the data of view_data.hpp, one copy of each mesh for all bodies.
// Two strings, since compilers limit the length of one.
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
out vec3 seen, normal, shade; flat out float number, isChosen;
vec3 rotated(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
void main() {
  vec4 at = view * vec4(place + size * rotated(turn, point), 1.0);
  seen = at.xyz; shade = colour; number = row; isChosen = row == chosen ? 1.0 : 0.0;
  normal = ball > 0.5 ? mat3(view) * rotated(turn, point) : vec3(0.0);
  gl_Position = projection * at;
}`;
const BODY_FRAGMENT = `#version 300 es
precision highp float;
in vec3 seen, normal, shade; flat in float number, isChosen;
uniform float picking, ghost, part;  // part 0: all, 1: the chosen body, 2: the others
out vec4 result;
void main() {
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
  result = vec4(c * light, ghost);
}`;
const LINE_VERTEX = `#version 300 es
layout(location=0) in vec3 point; layout(location=1) in vec3 colour;
uniform mat4 view, projection; out vec3 shade;
void main() { shade = colour; gl_Position = projection * view * vec4(point, 1.0); }`;
const LINE_FRAGMENT = `#version 300 es
precision highp float; in vec3 shade; out vec4 result; void main() { result = vec4(shade, 1.0); }`;
// viridis: rises evenly in brightness, so it reads in grey and for the colour-blind
const VIRIDIS = [[.267,.005,.329],[.279,.175,.483],[.230,.322,.546],[.173,.449,.558],[.128,.567,.551],[.158,.684,.502],[.369,.789,.383],[.678,.864,.190],[.993,.906,.144]];
function viridis(s) {
  const p = Math.min(Math.max(s, 0), 1) * (VIRIDIS.length - 1), i = Math.min(Math.floor(p), VIRIDIS.length - 2), f = p - i;
  return [0, 1, 2].map(k => VIRIDIS[i][k] * (1 - f) + VIRIDIS[i + 1][k] * f);
}
function unpacked(text, Type) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Type(bytes.buffer);
}
const minus = (a, b) => a.map((x, i) => x - b[i]), plus = (a, b) => a.map((x, i) => x + b[i]), times = (s, a) => a.map(x => s * x);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => times(1 / Math.hypot(...a), a);
)JS";

inline constexpr const char* kViewScript = R"JS(
function startView(canvas, panel, data) {
  const gl = canvas.getContext("webgl2", {alpha: false, antialias: true, preserveDrawingBuffer: true});
  if (!gl) { panel.textContent = "This browser has no WebGL 2: the view is not drawn. The pictures above show the same."; canvas.hidden = true; return; }
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
  const place = unpacked(data.position, Float32Array), turn = unpacked(data.orientation, Float32Array), size = unpacked(data.scale, Float32Array);
  const velocity = unpacked(data.velocity, Float32Array), shape = unpacked(data.shape, Uint16Array), material = unpacked(data.material, Uint16Array);
  const id = unpacked(data.id, Float64Array), touching = unpacked(data.touching, Uint16Array);
  const speed = new Float32Array(data.count);
  let fastest = 0;
  for (let i = 0; i < data.count; ++i) { speed[i] = Math.hypot(velocity[3 * i], velocity[3 * i + 1], velocity[3 * i + 2]); fastest = Math.max(fastest, speed[i]); }

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
    for (let i = 0; i < data.count; ++i) if (shape[i] === k) rows.push(i);
    if (rows.length === 0) return null;
    const gathered = (from, width) => { const to = new Float32Array(width * rows.length); rows.forEach((r, j) => { for (let c = 0; c < width; ++c) to[width * j + c] = from[width * r + c]; }); return to; };
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    buffer(unpacked(s.points, Float32Array), 0, 3, false);
    buffer(gathered(place, 3), 1, 3, true); buffer(gathered(turn, 4), 2, 4, true); buffer(gathered(size, 1), 3, 1, true);
    const colour = buffer(new Float32Array(3 * rows.length), 4, 3, true);
    buffer(Float32Array.from(rows), 5, 1, true);
    const corners = unpacked(s.corners, Uint32Array), index = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index); gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return {array, rows, colour, count: corners.length, ball: s.ball && !s.coarse};
  }).filter(s => s);
  const lineSet = (points, colours) => {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array); buffer(points, 0, 3, false); buffer(colours, 1, 3, false); gl.bindVertexArray(null);
    return {array, count: points.length / 3};
  };
  const edgePoints = unpacked(data.edges, Float32Array), edgeColours = new Float32Array(edgePoints.length).fill(0.45);
  const edges = lineSet(edgePoints, edgeColours);
  const linePoints = unpacked(data.lines, Float32Array), forces = unpacked(data.forces, Float32Array), lineColours = new Float32Array(linePoints.length);
  let strongest = 0;
  for (const f of forces) strongest = Math.max(strongest, f);
  forces.forEach((f, i) => { const c = viridis(f / strongest); for (let e = 0; e < 6; ++e) lineColours[6 * i + e] = c[e % 3]; });
  const lines = lineSet(linePoints, lineColours);

  const state = {chosen: -1, contacts: false, walls: true, colour: "shape"};
  const start = () => { const up = data.up; return {centre: [0, 0, 0], distance: 3.2 * data.radius, up, from: data.from}; };
  let camera = start();
  const legend = canvas.parentElement.querySelector(".legend");
  function paint() {
    for (const s of sets) {
      const c = new Float32Array(3 * s.rows.length);
      s.rows.forEach((r, j) => {
        const kind = state.colour === "material" ? material[r] : shape[r];
        c.set(state.colour === "speed" ? viridis(fastest > 0 ? speed[r] / fastest : 0) : data.colours[kind % data.colours.length], 3 * j);
      });
      gl.bindBuffer(gl.ARRAY_BUFFER, s.colour); gl.bufferData(gl.ARRAY_BUFFER, c, gl.STATIC_DRAW);
    }
    legend.textContent = "";
    const entry = (colour, text) => { const e = document.createElement("span"), b = document.createElement("i"); b.style.background = colour; e.append(b, text); legend.append(e); };
    const css = c => "rgb(" + c.map(x => Math.round(255 * x)).join(",") + ")";
    if (state.colour === "speed") {
      entry("linear-gradient(90deg," + VIRIDIS.map(css).join(",") + ")", "speed 0 to " + fastest.toPrecision(3) + " m/s");
    } else {
      const names = state.colour === "material" ? data.materials : data.shapes.map(s => s.name), used = new Set(state.colour === "material" ? material : shape);
      names.forEach((n, k) => { if (used.has(k)) entry(css(data.colours[k % data.colours.length]), n); });
    }
    if (state.contacts) entry("linear-gradient(90deg," + VIRIDIS.map(css).join(",") + ")", "normal force up to " + strongest.toPrecision(3) + " N");
    if (data.shapes.some(s => s.coarse)) entry("transparent", "shapes are drawn coarser than they are");
  }
  function matrices() {
    const z = camera.from, x = unit(cross(camera.up, z)), y = cross(z, x), eye = plus(camera.centre, times(camera.distance, z));
    const view = [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
    const aspect = canvas.width / canvas.height, f = 1 / Math.tan(Math.PI / 12) / (aspect < 1.2 ? 1.2 / aspect : 1);
    const far = camera.distance + 6 * data.radius, near = Math.max(far / 4000, camera.distance - 4 * data.radius);
    return {x, y, z, eye, view, projection: [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]};
  }
  function bodies(m, picking, part, ghost) {
    gl.useProgram(bodyProgram);
    const at = name => gl.getUniformLocation(bodyProgram, name);
    gl.uniformMatrix4fv(at("view"), false, m.view); gl.uniformMatrix4fv(at("projection"), false, m.projection);
    gl.uniform1f(at("picking"), picking ? 1 : 0); gl.uniform1f(at("chosen"), state.chosen); gl.uniform1f(at("part"), part); gl.uniform1f(at("ghost"), ghost);
    for (const s of sets) {
      gl.bindVertexArray(s.array); gl.uniform1f(at("ball"), s.ball ? 1 : 0);
      gl.drawElementsInstanced(gl.TRIANGLES, s.count, gl.UNSIGNED_INT, 0, s.rows.length);
    }
  }
  function strokes(m, set) {
    gl.useProgram(lineProgram);
    gl.uniformMatrix4fv(gl.getUniformLocation(lineProgram, "view"), false, m.view);
    gl.uniformMatrix4fv(gl.getUniformLocation(lineProgram, "projection"), false, m.projection);
    gl.bindVertexArray(set.array); gl.drawArrays(gl.LINES, 0, set.count);
  }
  function draw() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2), w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
    if (w > 0 && h > 0 && (canvas.width !== w || canvas.height !== h)) { canvas.width = w; canvas.height = h; }
    const m = matrices();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.957, 0.965, 0.976, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT); gl.enable(gl.DEPTH_TEST);
    if (state.walls) strokes(m, edges);
    if (!state.contacts) { bodies(m, false, 0, 1); return; }
    // the chosen body as it is, the others as ghosts that hide nothing, the forces among them
    bodies(m, false, 1, 1);
    gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA); gl.depthMask(false);
    bodies(m, false, 2, 0.07);
    gl.disable(gl.BLEND); gl.depthMask(true);
    strokes(m, lines);
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
    bodies(matrices(), true, 0, 1);
    const pixel = new Uint8Array(4), scale = canvas.width / canvas.clientWidth;
    gl.readPixels(Math.floor(px * scale), canvas.height - 1 - Math.floor(py * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(target); gl.deleteRenderbuffer(colour); gl.deleteRenderbuffer(depth);
    return pixel[3] === 0 ? -1 : pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1;
  }
  const show = x => String(Number(Number(x).toPrecision(4)));
  const metres = (values, i) => [0, 1, 2].map(c => show(values[3 * i + c])).join(", ");
  function choose(row) {
    state.chosen = row;
    if (row < 0) panel.textContent = "Pick a body to read about it.";
    else {
      const x = [0, 1, 2].map(c => show(place[3 * row + c] + data.centre[c])).join(", ");
      panel.textContent = "Body " + id[row] + ": " + data.shapes[shape[row]].name + " of " + data.materials[material[row]] + ", equivalent diameter " +
        show(size[row] * data.shapes[shape[row]].diameter) + " m, at (" + x + ") m, velocity (" + metres(velocity, row) + ") m/s, speed " +
        show(speed[row]) + " m/s, contacts: " + touching[row];
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
  tools.querySelector("[name=colour]").addEventListener("change", e => { state.colour = e.target.value; paint(); redraw(); });
  tools.querySelector("[name=contacts]").addEventListener("change", e => { state.contacts = e.target.checked; paint(); redraw(); });
  tools.querySelector("[name=walls]").addEventListener("change", e => { state.walls = e.target.checked; redraw(); });
  tools.querySelector("[name=nearer]").addEventListener("click", () => zoomBy(0.8));
  tools.querySelector("[name=further]").addEventListener("click", () => zoomBy(1.25));
  tools.querySelector("[name=reset]").addEventListener("click", () => { camera = start(); choose(-1); });
  new ResizeObserver(redraw).observe(canvas);
  window.addEventListener("beforeprint", draw);
  paint(); draw();

  // for tests: what share of the canvas bodies cover, and where on the page one of them is seen
  window.screeView = {
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
    state, cameraFrom: () => camera.from, distance: () => camera.distance
  };
}
startView(document.getElementById("view-canvas"), document.getElementById("view-panel"), JSON.parse(document.getElementById("view-data").textContent));
)JS";

}  // namespace scree
