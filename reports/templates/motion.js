/* Motions: the arm at an instant, its controls, and the time cursor of the curves of the same run. */

const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
const UNITS = { s: 1, ms: 1e3, "µs": 1e6 };
const ANGLE = 0.01; // rad for each pixel that a pointer is dragged
const motions = [];

const unpackRun = (run) => ({
  ...run,
  shapes: run.shapes.map((shape) => ({ ...shape, ends: floats(shape.ends) })),
  joints: run.joints.map((joint) => ({ ...joint, at: floats(joint.at) })),
  ...Object.fromEntries(["times", "tip", "target", "path", "desired"].map((name) => [name, floats(run[name])])),
});
const lengthOf = (run) => run.times[run.times.length - 1] ?? 0;

// Return what reads points of a run between two of its frames: of an array with so many points in a frame, one of them.
function instant(run, time) {
  const last = run.times.length - 1;
  let frame = run.times.findIndex((value) => value > time) - 1;
  if (frame < 0) frame = time < run.times[0] ? 0 : last;
  const next = Math.min(frame + 1, last);
  const part = next > frame ? Math.max(0, (time - run.times[frame]) / (run.times[next] - run.times[frame])) : 0;
  return (points, count = 1, item = 0) => [0, 1, 2].map((axis) => {
    const [one, other] = [frame, next].map((each) => points[3 * (each * count + item) + axis]);
    return one + part * (other - one);
  });
}

const points = (flat) => Array.from({ length: flat.length / 3 }, (_, at) => [...flat.subarray(3 * at, 3 * at + 3)]);
const magnified = (tip, target, factor) => tip.map((value, axis) => target[axis] + factor * (value - target[axis]));

function measure(runs) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { shapes, path, desired } of runs) {
    for (const [flat, radius] of [...shapes.map((shape) => [shape.ends, shape.radius]), [path, 0], [desired, 0]]) {
      flat.forEach((value, at) => {
        low[at % 3] = Math.min(low[at % 3], value - radius);
        high[at % 3] = Math.max(high[at % 3], value + radius);
      });
    }
  }
  const center = low.map((value, axis) => (Number.isFinite(value) ? (value + high[axis]) / 2 : 0));
  const radius = Math.max(1e-3, Math.hypot(...low.map((value, axis) => (Number.isFinite(value) ? high[axis] - value : 0))) / 2);
  return { low: low.map((value) => (Number.isFinite(value) ? value : 0)), center, radius };
}

// Return the largest magnification at which the largest error stays within the picture.
function fittingError(motion) {
  const errors = motion.runs.flatMap(({ tip, target }) => points(tip).map((point, at) => (
    Math.hypot(...point.map((value, axis) => value - target[3 * at + axis])))));
  const largest = errors.filter(Number.isFinite).reduce((most, value) => Math.max(most, value), 0);
  return [1000, 100, 10].find((factor) => largest * factor <= 0.6 * motion.extent.radius) ?? 1;
}

/* ---- the drawing ---- */

function camera(motion, width, height) {
  const { azimuth: a, elevation: e, zoom } = motion.view;
  const right = [-Math.sin(a), Math.cos(a), 0];
  const up = [-Math.cos(a) * Math.sin(e), -Math.sin(a) * Math.sin(e), Math.cos(e)];
  const near = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
  const scale = zoom * 0.46 * Math.min(width, 1.25 * height) / motion.extent.radius;
  const along = (point, axis) => point.reduce((sum, value, at) => sum + (value - motion.extent.center[at]) * axis[at], 0);
  return {
    scale,
    flat: (point) => [width / 2 + scale * along(point, right), height / 2 - scale * along(point, up)],
    depth: (point) => along(point, near),
  };
}

function stroke(context, line, color, width, dashes = []) {
  context.beginPath();
  line.forEach(([x, y], at) => (at ? context.lineTo(x, y) : context.moveTo(x, y)));
  Object.assign(context, { strokeStyle: color, lineWidth: width, lineCap: "round", lineJoin: "round" });
  context.setLineDash(dashes);
  context.stroke();
}

function write(context, text, x, y, ink, paper) {
  Object.assign(context, { font: "12px sans-serif", lineWidth: 3, strokeStyle: paper, fillStyle: ink, lineJoin: "round" });
  context.setLineDash([]);
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
}

function drawFloor(context, motion, { flat }, color) {
  const { low, center, radius } = motion.extent;
  const decade = 10 ** Math.floor(Math.log10(radius));
  const cell = decade / [5, 2, 1][[2, 4, Infinity].findIndex((most) => radius < most * decade)];
  const count = Math.ceil(1.2 * radius / cell);
  const [x, y] = center.map((value) => Math.round(value / cell) * cell);
  const z = Math.min(low[2], 0);
  for (let at = -count; at <= count; at += 1) {
    const reach = count * cell;
    stroke(context, [[x + at * cell, y - reach, z], [x + at * cell, y + reach, z]].map(flat), color, 0.7);
    stroke(context, [[x - reach, y + at * cell, z], [x + reach, y + at * cell, z]].map(flat), color, 0.7);
  }
}

function drawBodies(context, run, read, { flat, depth, scale }, colors) {
  const parts = run.shapes.map((shape) => {
    const ends = shape.balls ? [read(shape.ends)] : [read(shape.ends, 2, 0), read(shape.ends, 2, 1)];
    return { shape, ends, near: Math.max(...ends.map(depth)) };
  }).sort((one, other) => one.near - other.near);
  for (const { shape, ends } of parts) {
    const line = ends.map(flat);
    if (line.length === 1) line.push([line[0][0] + 0.01, line[0][1]]);
    const width = Math.max(2.5, 2 * scale * shape.radius);
    stroke(context, line, "rgb(0 0 0 / 55%)", width + 1.5);
    stroke(context, line, colors[shape.color % colors.length], width);
    const [across, down] = [0, 1].map((axis) => line[1][axis] - line[0][axis]);
    const shift = (0.22 * width) / Math.hypot(across, down);
    const bright = line.map(([x, y]) => [x + shift * Math.abs(down) * -1, y + shift * across * Math.sign(down || -1)]);
    if (ends.length > 1) stroke(context, bright, "rgb(255 255 255 / 22%)", 0.3 * width);
  }
}

function drawError(context, run, read, { flat }, factor, color) {
  if (factor === 1 || !run.tip.length) return;
  const trail = points(run.tip).map((tip, at) => flat(magnified(tip, [...run.target.subarray(3 * at, 3 * at + 3)], factor)));
  const target = read(run.target);
  const [x, y] = flat(magnified(read(run.tip), target, factor));
  stroke(context, trail, color, 1);
  stroke(context, [flat(target), [x, y]], color, 2.5);
  stroke(context, [[x, y], [x + 0.01, y]], color, 8);
}

const pathColor = (run, ghost, colors) => colors[(run.look ?? (ghost ? 3 : 1)) % colors.length];

function drawMotion(motion) {
  const { canvas, view, runs } = motion;
  const [width, height, ratio] = [canvas.clientWidth, canvas.clientHeight, window.devicePixelRatio || 1];
  if (!width || !height || printing) return;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  const [ink, paper, grid] = isDark() ? ["#d7dbe2", "#1e222a", "#343a45"] : ["#23272f", "#ffffff", "#e3e6ea"];
  const colors = isDark() ? palette.dark : palette.light;
  const seen = camera(motion, width, height);
  const shown = [runs[view.ghost], runs[view.run]].map((run, at) => run && { run, ghost: !at, read: instant(run, view.time) }).filter(Boolean);
  drawFloor(context, motion, seen, grid);
  for (const { run, ghost } of shown) {
    stroke(context, points(run.desired).map(seen.flat), "#8a929c", 1.5, [6, 4]);
    stroke(context, points(run.path).map(seen.flat), pathColor(run, ghost, colors), 1.5);
  }
  for (const { run, ghost, read } of shown) {
    context.globalAlpha = ghost ? 0.35 : 1;
    drawBodies(context, run, read, seen, ghost ? ["#8a929c"] : colors);
    context.globalAlpha = 1;
    drawError(context, run, read, seen, view.error, pathColor(run, ghost, colors));
  }
  const { run, read } = shown[shown.length - 1];
  const labels = [];
  for (const joint of run.joints) {
    const [x, y] = seen.flat(read(joint.at));
    const near = labels.find((label) => Math.abs(label.x - x) < 30 && Math.abs(label.y - y) < 13);
    if (near) near.text += `, ${joint.name}`;
    else labels.push({ x, y, text: joint.name });
  }
  for (const { text, x, y } of labels) write(context, text, x + 8, y - 6, ink, paper);
  const lines = shown.map((one) => (runs.length > 1 ? `${one.ghost ? "ghost: " : ""}${one.run.name}` : "")
    + (one.run.ends && view.time >= lengthOf(one.run) ? ` ${one.run.ends}` : "")).reverse();
  if (view.error !== 1) lines.push(`tip error × ${view.error}`);
  lines.filter((line) => line.trim()).forEach((line, at) => write(context, line.trim(), 10, 20 + 17 * at, ink, paper));
}

/* ---- the cursor ---- */

// Return the plots over time of a motion's run, or of the runs that are shown with it.
const curvesOf = (motion) => (typeof plots === "undefined" ? [] : plots).filter((plot) => plot.drawn && motionOf(plot) === motion);

function motionOf(plot) {
  const { figure } = plot;
  if (!figure?.dataset.of || !secondsOf(plot)) return undefined;
  return motions.find((one) => one.figure.dataset.of === figure.dataset.of
    && one.figure.closest("section") === figure.closest("section"));
}

// Return how many units of a plot's time axis make a second; nothing where the axis is not time.
const secondsOf = (plot) => UNITS[/^time \((\S+)\)$/.exec(readable(plot.panel.layout.xaxis.title.text))?.[1]];

function placeCursor(plot, motion) {
  const { xaxis, _size: size } = plot.element._fullLayout;
  let line = plot.element.parentElement.querySelector(".cursor");
  if (!line) {
    line = Object.assign(document.createElement("div"), { className: "cursor" });
    plot.element.before(line);
  }
  const left = xaxis.d2p(motion.view.time * secondsOf(plot));
  line.hidden = !(left >= 0 && left <= xaxis._length);
  Object.assign(line.style, { left: `${size.l + left}px`, top: `${plot.element.offsetTop + size.t}px`, height: `${size.h}px` });
}

// Called for each plot once it is drawn.
function followCursor(plot) {
  const motion = () => motionOf(plot);
  plot.element.on("plotly_afterplot", () => { if (motion()) placeCursor(plot, motion()); });
  plot.element.on("plotly_hover", ({ points: [point] }) => {
    if (motion() && !motion().playing) setTime(motion(), point.x / secondsOf(plot));
  });
  if (!motion()) return;
  placeCursor(plot, motion());
  showChosen(motion(), [plot]);
}

// Of curves that are named after the runs, those of the chosen ones are shown.
function showChosen(motion, own = curvesOf(motion)) {
  const names = motion.runs.map((run) => run.name);
  if (names.length < 3) return;
  const chosen = [motion.view.run, motion.view.ghost].map((at) => names[at]);
  for (const { element, panel } of own) {
    const found = [...panel.traces.keys()].filter((at) => names.includes(readable(panel.traces[at].name)));
    const visible = found.map((at) => chosen.includes(readable(panel.traces[at].name)) || "legendonly");
    if (found.length) window.Plotly.restyle(element, { visible }, found);
  }
}

/* ---- the view, which is in the address ---- */

const VIEW = ["time", "run", "ghost", "error"];

function setTime(motion, time) {
  motion.view.time = Math.min(Math.max(time, 0), motion.length);
  motion.slider.value = motion.view.time;
  motion.output.textContent = `${motion.view.time.toFixed(3)} s`;
  drawMotion(motion);
  for (const plot of curvesOf(motion)) placeCursor(plot, motion);
  clearTimeout(motion.timer);
  motion.timer = setTimeout(() => keepView(motion), 400);
}

function keepView({ figure, view, playing }) {
  if (playing || !view.touched) return;
  const values = VIEW.map((name) => `${name}=${name === "time" ? Number(view.time.toFixed(4)) : view[name]}`);
  window.history.replaceState(null, "", `#${figure.id}:${values.join(";")}`);
}

function takeView(motion) {
  const [id, text] = decodeURIComponent(window.location.hash.slice(1)).split(":");
  const linked = id === motion.figure.id && text;
  for (const [name, value] of linked ? text.split(";").map((pair) => pair.split("=")) : []) {
    const fits = name === "time" || [...motion.selects[name]?.options ?? []].some((option) => option.value === value);
    if (VIEW.includes(name) && fits && Number.isFinite(Number(value))) motion.view[name] = Number(value);
  }
  for (const [name, select] of Object.entries(motion.selects)) select.value = String(motion.view[name]);
  if (linked) motion.figure.scrollIntoView({ block: "center" });
}

/* ---- controls ---- */

function run(motion) {
  let before = null;
  const step = (now) => {
    if (!motion.playing) return;
    const time = motion.view.time + (before === null ? 0 : (now - before) / 1000) * motion.view.speed;
    before = now;
    if (time >= motion.length) pause(motion);
    setTime(motion, time);
    if (motion.playing) requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function pause(motion) {
  motion.playing = false;
  motion.button.textContent = "▶ Play in 3D";
}

function turn(motion, across, up) {
  motion.view.azimuth -= across;
  motion.view.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, motion.view.elevation + up));
  drawMotion(motion);
}

function listen(motion) {
  const { canvas, button, slider, selects, view } = motion;
  button.addEventListener("click", () => {
    if (motion.playing) return pause(motion);
    if (view.time >= motion.length) view.time = 0;
    motion.playing = true;
    button.textContent = "⏸ Pause";
    return run(motion);
  });
  slider.addEventListener("input", () => { view.touched = true; setTime(motion, Number(slider.value)); });
  for (const [name, select] of Object.entries(selects)) {
    select.addEventListener("change", () => {
      view[name] = Number(select.value);
      view.touched = true;
      if (name === "run" || name === "ghost") showChosen(motion);
      setTime(motion, view.time);
    });
  }
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) turn(motion, ANGLE * event.movementX, ANGLE * event.movementY);
  });
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    view.zoom *= Math.exp(-0.01 * event.deltaY);
    drawMotion(motion);
  }, { passive: false });
  const keys = {
    ArrowLeft: () => turn(motion, -0.1, 0), ArrowRight: () => turn(motion, 0.1, 0), ArrowUp: () => turn(motion, 0, 0.1),
    ArrowDown: () => turn(motion, 0, -0.1), "+": () => { view.zoom *= 1.1; }, "-": () => { view.zoom /= 1.1; },
  };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
    drawMotion(motion);
  });
  new ResizeObserver(() => requestAnimationFrame(() => drawMotion(motion))).observe(canvas);
  window.addEventListener("hashchange", () => { takeView(motion); showChosen(motion); setTime(motion, view.time); });
}

async function startMotions() {
  const figures = document.querySelectorAll("figure.playback");
  const data = figures.length ? JSON.parse(await inflate("plots")) : [];
  for (const figure of figures) {
    const { runs: packed, azimuth, elevation } = data[Number(figure.dataset.motion)];
    const runs = packed.map(unpackRun);
    if (!runs[0].times.length) continue;
    const part = (name) => figure.querySelector(name);
    const motion = {
      figure, runs, canvas: part("canvas"), button: part(".play"), slider: part("input"), output: part("output"),
      extent: measure(runs), length: Math.max(...runs.map(lengthOf)), playing: false,
      selects: Object.fromEntries([...figure.querySelectorAll("select")].map((select) => [select.name, select])),
      view: { time: 0, run: 0, ghost: runs.length > 1 ? runs.length - 1 : -1, speed: 1, zoom: 1, azimuth, elevation },
    };
    motion.view.error = motion.selects.error ? fittingError(motion) : 1;
    motion.slider.max = motion.length;
    part(".stage").classList.add("live");
    takeView(motion);
    listen(motion);
    motions.push(motion);
    setTime(motion, motion.view.time);
    for (const plot of curvesOf(motion)) followCursor(plot);
  }
  darkScreen.addEventListener("change", () => motions.forEach(drawMotion));
}

startMotions();
