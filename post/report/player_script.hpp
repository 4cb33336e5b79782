// Plays the frames of report.html: unpacks what player_data.hpp packed, and moves the 3D view (vtk/view_script.hpp) through them.
#pragma once

namespace scree {

inline constexpr const char* kPlayerScript = R"JS(
// Bodies of all frames, and where they are in the one that was loaded last. The frame of the pictures has the digits of the page's data.
function allFrames(data, play) {
  const table = play.table, count = table.count, bytes = unpacked(play.block, Uint8Array), exact = oneFrame(data);
  const moving = unpacked(play.wallPlaces, Float64Array), wide = 24 + (play.heat ? 2 : 0) + (play.contacts ? 2 : 0);
  const now = {place: new Float32Array(3 * count), turn: new Float32Array(4 * count), velocity: new Float32Array(3 * count), touching: new Uint16Array(count),
    temperature: play.heat ? new Float32Array(count) : null, present: new Uint8Array(count), walls: unpacked(data.wallPlaces, Float64Array)};
  let at = 0;
  const starts = play.frames.map(([, , bodies]) => { const start = at; at += (bodies < count ? Math.ceil(count / 8) : 0) + wide * bodies; return start; });
  const bits = new Uint32Array(1), asFloat = new Float32Array(bits.buffer);
  const word = p => bytes[p] | bytes[p + 1] << 8, long = p => word(p) | bytes[p + 2] << 16;
  const REACH = Math.SQRT1_2, part = [0, 0, 0, 0];
  function turn(p, row) {
    const words = [word(p), word(p + 2), word(p + 4)], largest = (words[0] >> 15) + 2 * (words[1] >> 15);
    let rest = 1, next = 0;
    for (let k = 0; k < 4; ++k) {
      if (k === largest) continue;
      part[k] = 2 * REACH * (words[next++] & 0x7fff) / 32767 - REACH;
      rest -= part[k] * part[k];
    }
    part[largest] = Math.sqrt(Math.max(0, rest));
    const norm = Math.hypot(...part);
    for (let k = 0; k < 4; ++k) now.turn[4 * row + k] = part[k] / norm;
  }
  function body(p, row) {
    for (let k = 0; k < 3; ++k) {
      now.place[3 * row + k] = play.lower[k] + long(p + 3 * k) * play.step[k] - data.centre[k];
      bits[0] = long(p + 15 + 3 * k) << 8;
      now.velocity[3 * row + k] = asFloat[0];
    }
    turn(p + 9, row);
    p += 24;
    if (play.heat) { now.temperature[row] = play.coldest + word(p) * play.temperatureStep; p += 2; }
    if (play.contacts) now.touching[row] = word(p);
  }
  function load(k) {
    const bodies = play.frames[k][2], all = bodies === count, mask = starts[k];
    let p = mask + (all ? 0 : Math.ceil(count / 8)), found = 0;
    for (let row = 0; row < count; ++row) {
      now.present[row] = all || bytes[mask + (row >> 3)] >> (row & 7) & 1 ? 1 : 0;
      if (!now.present[row]) continue;
      body(p, row);
      p += wide;
      if (k === play.chosen) copy(found, row);
      ++found;
    }
    play.moving.forEach((w, j) => { for (let c = 0; c < 7; ++c) now.walls[7 * w + c] = moving[7 * (play.moving.length * k + j) + c]; });
  }
  function copy(from, row) {
    for (const [name, width] of [["place", 3], ["turn", 4], ["velocity", 3], ["touching", 1], ["temperature", 1]]) {
      if (now[name]) for (let c = 0; c < width; ++c) now[name][width * row + c] = exact.now[name][width * from + c];
    }
  }
  return {count, id: unpacked(table.id, Float64Array), shape: unpacked(table.shape, Uint32Array), material: unpacked(table.material, Uint16Array),
    scale: unpacked(table.scale, Float32Array), frames: play.frames, chosen: play.chosen, contacts: play.contacts, scales: play.scales, now, load};
}
// Buttons, slider and keys. Nothing plays before the reader asks for it, whatever the reader's settings of motion are.
function startPlayer(view, canvas) {
  const bar = document.querySelector(".player"), button = bar.querySelector("[name=play]"), slider = bar.querySelector("[name=frame]"), rate = bar.querySelector("[name=rate]");
  const last = view.frames.length - 1;
  let playing = false, due = 0;
  function go(k) {
    view.showFrame(k);
    slider.value = k;
    const [number, time] = view.frames[k], text = "t = " + Number(time.toPrecision(4)) + " s";
    bar.querySelector("output").textContent = text + ", frame " + number;
    slider.setAttribute("aria-valuetext", text);
  }
  function set(on) {
    if (on === playing) return;
    playing = on;
    document.getElementById("view-panel").setAttribute("aria-live", on ? "off" : "polite");  // not every frame is read aloud
    button.textContent = on ? "\u275A\u275A pause" : "\u25B6 play";
    if (!on) return;
    due = 0;
    if (view.state.frame === last) go(0);
    requestAnimationFrame(step);
  }
  function step(time) {
    if (!playing) return;
    if (due === 0) due = time + 1000 / rate.value;
    if (time >= due) {
      go(view.state.frame + 1);
      due = Math.max(due + 1000 / rate.value, time);  // a slow machine shows all frames, later
      if (view.state.frame === last) { set(false); return; }
    }
    requestAnimationFrame(step);
  }
  button.addEventListener("click", () => set(!playing));
  slider.addEventListener("input", () => { set(false); go(Number(slider.value)); });
  for (const e of [canvas, slider]) e.addEventListener("keydown", event => { if (event.key === " ") { event.preventDefault(); set(!playing); } });
  go(view.state.frame);
  view.playing = () => playing;
}
{
  const data = dataOf("view-data"), canvas = document.getElementById("view-canvas");
  window.screeView = startView(canvas, document.getElementById("view-panel"), data, allFrames(data, data.player));
  if (window.screeView) startPlayer(window.screeView, canvas); else document.querySelector(".player").hidden = true;
}
)JS";

}  // namespace scree
