"use strict";
// The panel. It decodes frames by the rules of z2r/reading.py, z2r/angles.py and z2r/success.py; tests hold the two
// together. Names from the dataset are written with textContent only, so that none is ever taken for markup.

const byId = (id) => document.getElementById(id);
const all = (selector) => [...document.querySelectorAll(selector)];
const page = JSON.parse(byId("data").textContent);
const columns = decodeColumns(page);
const TURN = 2 * Math.PI;
const PLOTS = 12; // dimensions that are drawn at once

const now = { reading: page.readings[0], episode: 0, frame: 0, firstPlot: 0 };
let seen; // what the reading makes of every frame
let playing = null; // when it began, and at which frame
let drawing = false;

function decodeColumns({ frames, bytes, names, shown }) {
  const raw = Uint8Array.from(atob(frames), (char) => char.charCodeAt(0));
  const values = bytes === 8 ? new Float64Array(raw.buffer) : new Float32Array(raw.buffer);
  return names.map((_, column) => values.subarray(column * shown, (column + 1) * shown));
}

function wrapAngle(angle) {
  let wrapped = (angle + Math.PI) % TURN;
  if (wrapped < 0) wrapped += TURN;
  wrapped -= Math.PI;
  return wrapped >= Math.PI ? -Math.PI : wrapped;
}

function readPose([x, y, sin, cos]) {
  const yaw = Float64Array.from(columns[sin], (value, frame) => Math.atan2(value, columns[cos][frame]));
  return { x: columns[x], y: columns[y], yaw };
}

function readFrames({ tee, target }) {
  if (!tee) return null;
  const block = readPose(tee);
  const goal = readPose(target);
  return {
    block,
    goal,
    pos: Float64Array.from(block.x, (x, i) => Math.hypot(x - goal.x[i], block.y[i] - goal.y[i])),
    ang: block.yaw.map((yaw, i) => Math.abs(wrapAngle(yaw - goal.yaw[i]))),
  };
}

// --- what is shown -------------------------------------------------------------------------------------------------

/** First frame of the episode, and one past the last that the page holds. */
const span = () => {
  const [from, to] = now.reading.episodes[now.episode];
  return [from, Math.min(to, page.shown)];
};
const nFrames = () => span()[1] - span()[0];

function chooseReading(name) {
  now.reading = page.readings.find((reading) => reading.name === name);
  seen = readFrames(now.reading);
  for (const part of all("[data-reading]")) part.hidden = part.dataset.reading !== name;
  const options = now.reading.numbers.map((number, episode) => new Option(number, episode));
  byId("episode").replaceChildren(...options);
  for (const [i, code] of all("[data-formula]").entries()) {
    code.textContent = now.reading.formulas[i];
    code.classList.toggle("changed", now.reading.formulas[i] !== page.readings[0].formulas[i]);
  }
  document.body.classList.toggle("wrong", now.reading !== page.readings[0]);
}

function switchReading(name) {
  const at = span()[0] + now.frame; // the same frame of the dataset, whatever episode it is in
  chooseReading(name);
  const episode = now.reading.episodes.findIndex(([from, to]) => from <= at && at < to);
  chooseEpisode(episode, at - now.reading.episodes[episode][0]);
  if (playing) playing = { frame: now.frame, since: performance.now() };
  byId("said").textContent = now.reading.said;
}

function chooseEpisode(episode, frame = 0) {
  now.episode = Math.min(Math.max(episode, 0), now.reading.episodes.length - 1);
  byId("episode").value = now.episode;
  byId("previous").disabled = now.episode === 0;
  byId("next").disabled = now.episode === now.reading.episodes.length - 1;
  byId("frame").max = nFrames() - 1;
  const reached = now.reading.reached?.[now.episode];
  const verdict = { true: ", reached", false: ", not reached" }[reached] ?? "";
  const [from, to] = now.reading.episodes[now.episode];
  const cut = nFrames() < to - from ? `the first ${nFrames().toLocaleString("en")} of ` : "";
  byId("verdict").textContent = `${cut}${(to - from).toLocaleString("en")} frames${verdict}`;
  for (const here of all(".here")) {
    here.setAttribute("x", `${(100 * from) / page.total}%`);
    here.setAttribute("width", `${(100 * (to - from)) / page.total}%`);
  }
  if (seen) drawEpisode();
  else drawPlots();
  chooseFrame(frame);
}

function chooseFrame(frame) {
  now.frame = Math.min(Math.max(frame, 0), nFrames() - 1);
  if (drawing) return; // keys can repeat faster than the screen is drawn
  drawing = true;
  requestAnimationFrame(drawFrame);
}

// --- traces --------------------------------------------------------------------------------------------------------

function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** Draw one value over an episode, in percent of the height, with a band that is within tolerance. */
function makeTrace(figure, label) {
  const band = svg("rect", { class: "band", width: "100%" });
  const line = svg("polyline", { class: "line" });
  const cursor = svg("line", { class: "cursor", y1: "0", y2: "100%" });
  const dot = svg("circle", { class: "dot", r: 5 });
  const stretched = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none" }, line);
  const plot = svg("svg", { class: "plot", role: "img", "aria-label": label }, band, stretched, cursor, dot);
  const [high, low, limit] = ["high", "low", "limit"].map((name) => {
    const text = document.createElement("span");
    text.className = name;
    return text;
  });
  const area = document.createElement("div");
  area.className = "area";
  area.append(plot, high, low, limit);
  figure.append(area);
  scrubWith(plot);
  let scale;
  return {
    setEpisode(values, bottom, top, unit, tolerance) {
      scale = (value) => 96 - (76 * (value - bottom)) / (top - bottom || 1);
      line.setAttribute("points", thinned(values, scale));
      band.setAttribute("y", `${scale(tolerance ?? bottom)}%`);
      band.setAttribute("height", tolerance === undefined ? 0 : `${scale(bottom) - scale(tolerance)}%`);
      high.textContent = `${short(top)} ${unit}`;
      low.textContent = tolerance === undefined ? `${short(bottom)} ${unit}` : "";
      limit.textContent = tolerance === undefined ? "" : `tolerance ${tolerance} ${unit}`;
      limit.style.top = `${scale(tolerance ?? bottom)}%`;
    },
    setFrame(value, frame, last) {
      const x = `${last ? (100 * frame) / last : 0}%`;
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
      dot.setAttribute("cx", x);
      dot.setAttribute("visibility", Number.isFinite(value) ? "visible" : "hidden");
      if (Number.isFinite(value)) dot.setAttribute("cy", `${scale(value)}%`);
    },
  };
}

/** The points of a line; of a long one, the least and the greatest value in each of 600 pieces. */
function thinned(values, scale) {
  const step = Math.max(1, Math.ceil(values.length / 600));
  const last = Math.max(values.length - 1, 1);
  const points = [];
  for (let start = 0; start < values.length; start += step) {
    const piece = values.subarray(start, start + step).filter(Number.isFinite);
    if (!piece.length) continue;
    const ends = step === 1 ? [piece[0]] : [Math.min(...piece), Math.max(...piece)];
    for (const value of ends) points.push(`${(100 * start) / last},${scale(value)}`);
  }
  return points.join(" ");
}

const short = (value) => (Number.isInteger(value) ? value : Number(value.toPrecision(3)));

function scrubWith(plot) {
  const follow = (event) => {
    if (event.buttons !== 1) return;
    const box = plot.getBoundingClientRect();
    pickFrame(Math.round(((event.clientX - box.left) / box.width) * (nFrames() - 1)));
  };
  plot.addEventListener("pointerdown", follow);
  plot.addEventListener("pointermove", follow);
}

// --- the world -----------------------------------------------------------------------------------------------------

const scene = byId("scene");
const part = (name) => scene.querySelector(name);
const traces = scene && { pos: makeTrace(byId("pos"), "Distance over time"), ang: makeTrace(byId("ang"), "Angle over time") };
let paths; // the points of block and pusher in this episode

function drawEpisode() {
  const [from, to] = span();
  const [x, y] = now.reading.pusher;
  const farthest = Math.max(2 * now.reading.posTol, seen.pos.subarray(from, to).reduce((a, b) => Math.max(a, b), 0));
  traces.pos.setEpisode(seen.pos.subarray(from, to), 0, farthest, "m", now.reading.posTol);
  traces.ang.setEpisode(seen.ang.subarray(from, to), 0, Math.PI, "rad", now.reading.angTol);
  paths = { tee: points(seen.block.x, seen.block.y), pusher: points(columns[x], columns[y]) };
  for (const name of ["tee", "pusher"]) {
    part(`.ahead.${name}-line`).setAttribute("points", paths[name].slice(0, page.longestPath).join(" "));
  }
}

function points(x, y) {
  const [from, to] = span();
  return Array.from(x.subarray(from, to), (value, i) => `${value},${y[from + i]}`);
}

function drawWorld(at) {
  const { block, goal, pos, ang } = seen;
  const place = (pose) => `translate(${pose.x[at]} ${pose.y[at]}) rotate(${degrees(pose.yaw[at])})`;
  const [x, y] = now.reading.pusher.map((column) => columns[column][at]);
  part(".tee").setAttribute("transform", place(block));
  part(".target").setAttribute("transform", place(goal));
  part(".pusher").setAttribute("cx", x);
  part(".pusher").setAttribute("cy", y);
  part(".action").setAttribute("d", arrow(x, y, at));
  for (const name of ["tee", "pusher"]) {
    const path = paths[name].slice(Math.max(0, now.frame + 1 - page.longestPath), now.frame + 1);
    part(`.path.${name}-line`).setAttribute("points", path.join(" "));
  }
  for (const cell of all("[data-column]")) cell.textContent = columns[cell.dataset.column][at].toFixed(4);
  for (const [i, cell] of all("[data-yaw]").entries()) cell.textContent = angle([block, goal][i].yaw[at]);
  writeError("pos", pos[at], `${pos[at].toFixed(4)} m`, now.reading.posTol, "m");
  writeError("ang", ang[at], angle(ang[at]), now.reading.angTol, "rad");
}

function writeError(name, value, text, tolerance, unit) {
  const within = value <= tolerance;
  const mark = byId(name).querySelector(".mark");
  traces[name].setFrame(value, now.frame, nFrames() - 1);
  byId(name).querySelector(".value").textContent = text;
  mark.textContent = `${within ? "\u2713 within" : "\u2717 not within"} ${tolerance} ${unit}`;
  mark.classList.toggle("within", within);
}

const degrees = (radians) => (radians * 180) / Math.PI;
const angle = (radians) => `${radians.toFixed(4)} rad = ${degrees(radians).toFixed(1)}\u00b0`;

/** From the pusher to where the action would take it in one frame. */
function arrow(x, y, at) {
  const [dx, dy] = (now.reading.action ?? []).map((column) => columns[column][at] / page.fps);
  const length = Math.hypot(dx, dy);
  if (!(length > 0.001)) return "";
  const head = Math.min(0.012, length / 2) / length;
  const [tipX, tipY] = [x + dx, y + dy];
  const barb = (side) => `${tipX - head * (dx - side * 0.6 * dy)} ${tipY - head * (dy + side * 0.6 * dx)}`;
  return `M${x} ${y}L${tipX} ${tipY}M${barb(1)}L${tipX} ${tipY}L${barb(-1)}`;
}

// --- any other robot: a trace for every dimension --------------------------------------------------------------------

let plots = [];

function drawPlots() {
  const chosen = page.names.slice(now.firstPlot, now.firstPlot + PLOTS);
  plots = chosen.map(([feature, name], i) => {
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    const [title, value] = [document.createElement("b"), document.createElement("span")];
    title.textContent = `${feature}: ${name}`;
    value.className = "value";
    figure.className = "trace";
    caption.append(title, " ", value);
    figure.append(caption);
    const trace = makeTrace(figure, title.textContent);
    const column = columns[now.firstPlot + i];
    const finite = column.filter(Number.isFinite);
    const extreme = (choose) => finite.reduce((a, b) => choose(a, b), finite[0] ?? 0);
    trace.setEpisode(column.subarray(...span()), extreme(Math.min), extreme(Math.max), "");
    return { figure, trace, column, value };
  });
  byId("plots").replaceChildren(...plots.map((plot) => plot.figure));
  byId("pager").hidden = page.names.length <= PLOTS;
  const last = now.firstPlot + chosen.length;
  byId("which").textContent = `dimensions ${now.firstPlot + 1} to ${last} of ${page.names.length}`;
  byId("fewer").disabled = now.firstPlot === 0;
  byId("more").disabled = last === page.names.length;
}

function turnPage(step) {
  now.firstPlot += step * PLOTS;
  drawPlots();
  chooseFrame(now.frame);
}

// --- one frame -----------------------------------------------------------------------------------------------------

function drawFrame() {
  drawing = false;
  const at = span()[0] + now.frame;
  const seconds = (now.frame / page.fps).toFixed(1);
  const last = nFrames() - 1;
  byId("frame").value = now.frame;
  byId("frame").style.setProperty("--done", `${last ? (100 * now.frame) / last : 0}%`);
  byId("frame").setAttribute("aria-valuetext", `frame ${now.frame} of 0 to ${last}, ${seconds} seconds`);
  byId("clock").textContent = `frame ${now.frame} of 0\u2013${last}, ${seconds} s`;
  if (seen) drawWorld(at);
  for (const { trace, column, value } of plots) {
    trace.setFrame(column[at], now.frame, last);
    value.textContent = Number(column[at].toPrecision(5));
  }
}

// --- time ----------------------------------------------------------------------------------------------------------

function play() {
  const frame = now.frame === nFrames() - 1 ? 0 : now.frame;
  playing = { frame, since: performance.now() };
  byId("play").textContent = "Pause";
  chooseFrame(frame);
  requestAnimationFrame(advance);
}

function stop() {
  playing = null;
  byId("play").textContent = "Play";
}

function advance(time) {
  if (!playing) return;
  const due = playing.frame + Math.max(0, Math.floor(((time - playing.since) / 1000) * page.fps));
  if (due > now.frame) chooseFrame(due);
  if (now.frame === nFrames() - 1) stop();
  else requestAnimationFrame(advance);
}

const toggle = () => (playing ? stop() : play());

function onKey(event) {
  const inPlayer = event.target === document.body || byId("player").contains(event.target);
  if (!inPlayer || event.target.tagName === "SELECT" || event.altKey || event.ctrlKey || event.metaKey) return;
  const step = event.shiftKey ? 10 : 1;
  const targets = { ArrowLeft: now.frame - step, ArrowRight: now.frame + step, Home: 0, End: nFrames() - 1 };
  if (event.key in targets) {
    pickFrame(targets[event.key]);
  } else if (event.key === " " && event.target.tagName !== "BUTTON") toggle();
  else return;
  event.preventDefault();
}

function pickInRibbon(event) {
  const box = event.currentTarget.getBoundingClientRect();
  const at = ((event.clientX - box.left) / box.width) * page.total;
  const episode = now.reading.episodes.findIndex(([from, to]) => from <= at && at < to);
  if (episode >= 0) pickEpisode(episode);
}

function pickEpisode(episode) {
  stop();
  chooseEpisode(episode);
}

function pickFrame(frame) {
  stop();
  chooseFrame(frame);
}

byId("transport").hidden = false;
byId("switch").hidden = page.readings.length === 1;
byId("switch").addEventListener("change", (event) => switchReading(event.target.value));
// Whoever chose with the mouse means the frames by the next arrow key. A focused radio button would choose again.
byId("switch").addEventListener("click", (event) => {
  if (event.pointerType) setTimeout(() => document.activeElement.blur());
});
byId("episode").addEventListener("change", (event) => pickEpisode(Number(event.target.value)));
byId("previous").addEventListener("click", () => pickEpisode(now.episode - 1));
byId("next").addEventListener("click", () => pickEpisode(now.episode + 1));
byId("frame").addEventListener("input", (event) => pickFrame(Number(event.target.value)));
byId("play").addEventListener("click", toggle);
byId("fewer")?.addEventListener("click", () => turnPage(-1));
byId("more")?.addEventListener("click", () => turnPage(1));
for (const ribbon of all(".ribbon")) ribbon.addEventListener("click", pickInRibbon);
document.addEventListener("keydown", onKey);

chooseReading(page.readings[0].name);
chooseEpisode(0);
