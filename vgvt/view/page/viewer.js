"use strict";
// Animated mode shapes on a canvas: play and pause, choose a mode, drag to turn, arrow keys to turn.
(() => {
  const stage = document.getElementById("stage");
  if (!stage) return;
  const scene = JSON.parse(document.getElementById("shape-data").textContent);
  const models = scene.models;
  const pick = (id) => document.getElementById(id);
  const [modelSelect, modeSelect, playButton, slider] = ["viewer-model", "viewer-mode", "viewer-play", "viewer-scale"].map(pick);
  const context = stage.getContext("2d");
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const state = { playing: !still, phase: 0, azimuth: 0.3, elevation: 0.5, last: null };
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  const all = [...scene.outline.flat(), ...models.flatMap((m) => m.nodes)];
  const centre = [0, 1, 2].map((k) => (Math.min(...all.map((p) => p[k])) + Math.max(...all.map((p) => p[k]))) / 2);
  const span = Math.max(...[0, 1, 2].map((k) => Math.max(...all.map((p) => p[k])) - Math.min(...all.map((p) => p[k]))), 1e-6);

  function fillModes() {
    modeSelect.replaceChildren(...models[Number(modelSelect.value)].modes.map((mode, k) => new Option(mode.title, k)));
  }

  function project(p, width, height) {
    const [x, y, z] = p.map((v, k) => v - centre[k]);
    const [sa, ca, se, ce] = [Math.sin(state.azimuth), Math.cos(state.azimuth), Math.sin(state.elevation), Math.cos(state.elevation)];
    const scale = Math.min(width * 0.9, height * 1.9) / span;
    const near = ca * x - sa * y;
    return [width / 2 + scale * (sa * x + ca * y), height / 2 - scale * (ce * z - se * near), ce * near + se * z];
  }
  function path(points, closed) {
    context.beginPath();
    points.forEach((p, k) => (k ? context.lineTo(p[0], p[1]) : context.moveTo(p[0], p[1])));
    if (closed) context.closePath();
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [stage.clientWidth, stage.clientHeight];
    if (stage.width !== Math.round(width * ratio)) { stage.width = Math.round(width * ratio); stage.height = Math.round(height * ratio); }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const model = models[Number(modelSelect.value)];
    const mode = model.modes[Number(modeSelect.value)];
    const colours = { ink: css("--ink"), soft: css("--soft"), up: css("--positive"), down: css("--negative") };

    context.lineJoin = "round";
    context.strokeStyle = colours.soft; context.fillStyle = css("--body"); context.lineWidth = 1;
    for (const ring of scene.outline) { path(ring.map((p) => project(p, width, height)), true); context.fill(); context.stroke(); }
    if (!mode) return;

    const [c, s] = [Math.cos(state.phase), Math.sin(state.phase)];
    const now = mode.re.map((re, n) => re.map((v, k) => v * c - mode.im[n][k] * s));
    const size = Number(slider.value) / 100 * 0.3 * span;
    const points = model.nodes.map((p, n) => project(p.map((v, k) => v + size * now[n][k]), width, height));
    const faces = model.faces.map((face) => ({
      ring: face.map((n) => points[n]),
      depth: face.reduce((sum, n) => sum + points[n][2], 0) / face.length,
      level: face.reduce((sum, n) => sum + now[n][mode.axis], 0) / face.length,
    })).sort((a, b) => a.depth - b.depth);
    for (const face of faces) {
      context.fillStyle = face.level >= 0 ? colours.up : colours.down;
      context.globalAlpha = 0.12 + 0.7 * Math.min(Math.abs(face.level), 1);
      path(face.ring, true); context.fill();
    }
    context.globalAlpha = 1; context.strokeStyle = colours.ink; context.lineWidth = 1.6;
    for (const [a, b] of model.edges) { path([points[a], points[b]], false); context.stroke(); }
    points.forEach((p, n) => {
      const level = now[n][mode.axis];
      context.fillStyle = level >= 0 ? colours.up : colours.down;
      context.beginPath(); context.arc(p[0], p[1], 4, 0, 2 * Math.PI); context.fill();
    });
  }

  function frame(time) {
    if (!state.playing) { state.last = null; return; }
    if (state.last !== null) state.phase = (state.phase + (time - state.last) / 1000 * 2 * Math.PI * 0.6) % (2 * Math.PI);
    state.last = time;
    draw();
    requestAnimationFrame(frame);
  }
  function play(on) {
    state.playing = on;
    playButton.textContent = on ? "❚❚ Pause" : "▶ Play";
    playButton.setAttribute("aria-pressed", String(on));
    if (on) requestAnimationFrame(frame); else draw();
  }
  function turn(dx, dy) {
    state.azimuth += dx;
    state.elevation = Math.max(-1.5, Math.min(1.5, state.elevation + dy));
    if (!state.playing) draw();
  }

  playButton.addEventListener("click", () => play(!state.playing));
  modelSelect.addEventListener("change", () => { fillModes(); draw(); });
  for (const input of [modeSelect, slider]) input.addEventListener("input", draw);
  stage.addEventListener("pointerdown", (event) => stage.setPointerCapture(event.pointerId));
  stage.addEventListener("pointermove", (event) => { if (event.buttons) turn(event.movementX * 0.008, event.movementY * 0.008); });
  stage.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    if (step) { event.preventDefault(); turn(...step); }
  });
  new ResizeObserver(draw).observe(stage);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  fillModes();
  play(state.playing);
})();
