"use strict";
// The panel. It decodes nothing: positions, yaws, errors and whether they are within their limits come with the page,
// worked out by the package. Names from the dataset are written with textContent only, so that none is ever taken for
// markup.

const byId = (id) => document.getElementById(id);
const all = (selector) => [...document.querySelectorAll(selector)];
const page = JSON.parse(byId("data").textContent);
const bytesOf = (text) => Uint8Array.from(atob(text), (char) => char.charCodeAt(0));
const columns = decodeColumns(page);
const PLOTS = 12; // dimensions that are drawn at once

let held = []; // a bit for each goal and frame: whether it is within its limits
const now = { reading: page.readings[0], episode: 0, frame: 0, firstPlot: 0 };
let playing = null; // when it began, and at which frame
let drawing = false;

function decodeColumns({ frames, bytes, shown }) {
  const raw = bytesOf(frames);
  const values = bytes === 8 ? new Float64Array(raw.buffer) : new Float32Array(raw.buffer);
  return Array.from({ length: values.length / shown }, (_, i) => values.subarray(i * shown, (i + 1) * shown));
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
  held = now.reading.goals.map((goal) => bytesOf(goal.held));
  for (const part of all("[data-reading]")) part.hidden = part.dataset.reading !== name;
  const options = now.reading.numbers.map((number, episode) => new Option(number, episode));
  byId("episode").replaceChildren(...options);
  for (const code of all("[data-formula]")) {
    const pose = code.dataset.formula;
    code.textContent = now.reading.formulas[pose];
    code.classList.toggle("changed", now.reading.formulas[pose] !== page.readings[0].formulas[pose]);
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
  const stored = { true: ", stored: success", false: ", stored: no success" }[now.reading.stored?.[now.episode]] ?? "";
  const [from, to] = now.reading.episodes[now.episode];
  const cut = nFrames() < to - from ? `the first ${nFrames().toLocaleString("en")} of ` : "";
  byId("verdict").textContent = `${cut}${(to - from).toLocaleString("en")} frames${verdict}${stored}`;
  for (const here of all(".here")) {
    here.setAttribute("x", `${(100 * from) / page.total}%`);
    here.setAttribute("width", `${(100 * (to - from)) / page.total}%`);
  }
  drawGoals();
  if (scene) drawPaths();
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

/** Draw one value over an episode, in percent of the height, with the band of values that are within the limits. */
function makeTrace(figure, label) {
  const shade = svg("rect", { class: "band", width: "100%" });
  const line = svg("polyline", { class: "line" });
  const cursor = svg("line", { class: "cursor", y1: "0", y2: "100%" });
  const dot = svg("circle", { class: "dot", r: 5 });
  const stretched = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none" }, line);
  const plot = svg("svg", { class: "plot", role: "img", "aria-label": label }, shade, stretched, cursor, dot);
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
    setEpisode(values, bottom, top, unit, band = null, said = "", edge = null) {
      scale = (value) => 96 - (76 * (value - bottom)) / (top - bottom || 1);
      line.setAttribute("points", thinned(values, scale));
      const [from, to] = band ?? [bottom, bottom];
      shade.setAttribute("y", `${scale(to)}%`);
      shade.setAttribute("height", `${scale(from) - scale(to)}%`);
      high.textContent = `${short(top)} ${unit}`;
      low.textContent = band ? "" : `${short(bottom)} ${unit}`;
      limit.textContent = edge === null ? "" : said;
      limit.style.top = `${scale(edge ?? bottom)}%`;
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

// --- goals -----------------------------------------------------------------------------------------------------------

const goalFigures = all(".trace.goal");
const goalTraces = goalFigures.map((figure, i) => makeTrace(figure, `${page.readings[0].goals[i].label} over time`));

function drawGoals() {
  for (const [i, goal] of now.reading.goals.entries()) {
    const values = columns[goal.column].subarray(...span());
    const finite = values.filter(Number.isFinite);
    const [low, high] = goal.band ?? [null, null];
    const extreme = (choose) => finite.reduce((a, b) => choose(a, b), choose(0, high ?? low ?? 0));
    const bottom = extreme(Math.min);
    const top = goal.isAngle ? Math.PI : Math.max(extreme(Math.max), 2 * (high ?? 0), 2 * (low ?? 0));
    const band = goal.band && [Math.max(low ?? bottom, bottom), high ?? top];
    goalTraces[i].setEpisode(values, bottom, top, goal.unit, band, goal.limit, high ?? low);
  }
}

function drawGoal(i, at) {
  const goal = now.reading.goals[i];
  const value = columns[goal.column][at];
  const within = Boolean((held[i][at >> 3] >> (7 - (at & 7))) & 1);
  const mark = goalFigures[i].querySelector(".mark");
  goalTraces[i].setFrame(value, now.frame, nFrames() - 1);
  goalFigures[i].querySelector(".value").textContent = goal.isAngle ? angle(value) : `${value.toFixed(4)} ${goal.unit}`;
  mark.textContent = `${within ? "\u2713" : "\u2717 not"} ${goal.limit}`;
  mark.classList.toggle("within", within);
}

const degrees = (radians) => (radians * 180) / Math.PI;
const angle = (radians) => `${radians.toFixed(4)} rad = ${degrees(radians).toFixed(1)}\u00b0`;

// --- the world -------------------------------------------------------------------------------------------------------

const scene = byId("scene");
const parts = (kind) => (scene ? [...scene.querySelectorAll(kind)].map((part) => [part, part.dataset.pose]) : []);
const bodies = parts(".body");
const trails = parts(".path");
const trailsAhead = parts(".ahead");
let points = {}; // of each body that moves, in this episode

function drawPaths() {
  const [from, to] = span();
  for (const [line, pose] of trailsAhead) {
    const [x, y] = now.reading.poses[pose].map((column) => columns[column]);
    points[pose] = Array.from(x.subarray(from, to), (value, i) => `${value},${y[from + i]}`);
    line.setAttribute("points", points[pose].slice(0, page.longestPath).join(" "));
  }
}

function drawWorld(at) {
  for (const [body, pose] of bodies) {
    const [x, y, yaw] = now.reading.poses[pose].map((column) => (column === null ? 0 : columns[column][at]));
    body.setAttribute("transform", `translate(${x} ${y}) rotate(${degrees(yaw)})`);
  }
  for (const [line, pose] of trails) {
    const path = points[pose].slice(Math.max(0, now.frame + 1 - page.longestPath), now.frame + 1);
    line.setAttribute("points", path.join(" "));
  }
  scene.querySelector(".action").setAttribute("d", arrow(at));
}

/** From the body that the action drives to where it would take it in one frame. */
function arrow(at) {
  if (!now.reading.action) return "";
  const { pose, columns: driven, scale, isPlace } = now.reading.action;
  const [x, y] = now.reading.poses[pose].map((column) => columns[column]?.[at]);
  const [askedX, askedY] = driven.map((column) => scale * columns[column][at]);
  const [dx, dy] = isPlace ? [askedX - x, askedY - y] : [askedX, askedY];
  const length = Math.hypot(dx, dy);
  if (!(length > 0.0025 * reach)) return "";
  const head = Math.min(0.03 * reach, length / 2) / length;
  const [tipX, tipY] = [x + dx, y + dy];
  const barb = (side) => `${tipX - head * (dx - side * 0.6 * dy)} ${tipY - head * (dy + side * 0.6 * dx)}`;
  return `M${x} ${y}L${tipX} ${tipY}M${barb(1)}L${tipX} ${tipY}L${barb(-1)}`;
}

// Half the width of the picture, in the unit of the positions.
const reach = scene ? 410 / Number(/scale\(([^ ]+)/.exec(scene.querySelector("g").getAttribute("transform"))[1]) : 1;

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

const cells = all("[data-column]");
const yaws = all("[data-yaw]");

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
  for (const i of now.reading.goals.keys()) drawGoal(i, at);
  for (const cell of cells) cell.textContent = columns[cell.dataset.column][at].toFixed(4);
  for (const cell of yaws) cell.textContent = angle(columns[now.reading.poses[cell.dataset.yaw][2]][at]);
  if (scene) drawWorld(at);
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
