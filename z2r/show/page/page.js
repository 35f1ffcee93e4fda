"use strict";
// The panel. It decodes nothing: positions, yaws, errors and whether they are within their limits come with the page,
// worked out by the package. Names from the dataset are written with textContent only, so that none is ever taken for
// markup.

const byId = (id) => document.getElementById(id);
const all = (selector) => [...document.querySelectorAll(selector)];
const page = JSON.parse(byId("data").textContent);
const bytesOf = (text) => Uint8Array.from(atob(text), (char) => char.charCodeAt(0));
const columns = decodeColumns(page);
const CHARTS = 24; // that are drawn at once

let held = []; // a bit for each goal and frame: whether it is within its limits
const right = page.readings[0];
const now = { reading: right, episode: 0, frame: 0, listed: [], firstChart: 0 };
let playing = null; // since when, and from which frame on
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

/** Which episodes there are to choose from. */
const FILTERS = {
  all: ["all episodes", () => true],
  missed: ["not reached", (episode) => now.reading.reached?.[episode] === false],
  failed: ["no success", (episode) => now.reading.stored?.[episode] === false],
  found: ["with findings", (episode) => hasEpisodes() && numbersFound.has(now.reading.numbers[episode])],
};
const numbersFound = new Set(page.findings.flatMap((finding) => finding.episodes));
const hasEpisodes = () => now.reading.episodes.length === right.episodes.length;

function chooseReading(name) {
  now.reading = page.readings.find((reading) => reading.name === name);
  held = now.reading.goals.map((goal) => bytesOf(goal.held));
  for (const part of all("[data-reading]")) part.hidden = part.dataset.reading !== name;
  for (const radio of all("#switch input")) radio.checked = radio.value === name;
  for (const code of all("[data-formula]")) {
    const pose = code.dataset.formula;
    code.textContent = now.reading.formulas[pose];
    code.classList.toggle("changed", now.reading.formulas[pose] !== right.formulas[pose]);
  }
  document.body.classList.toggle("wrong", now.reading !== right);
  listFilters();
}

/** Offer the filters of which some episode is left, and go on without one of which none is. */
function listFilters() {
  const chosen = byId("filter").value || "all";
  const options = Object.entries(FILTERS).map(([name, [label, holds]]) => {
    const n = now.reading.numbers.filter((_, episode) => holds(episode)).length;
    const option = new Option(name === "all" ? label : `${label} (${n})`, name, false, name === chosen);
    option.hidden = option.disabled = n === 0;
    return option;
  });
  byId("filter").replaceChildren(...options);
  if (byId("filter").selectedOptions[0]?.disabled ?? true) byId("filter").value = "all";
  byId("filter").hidden = options.filter((option) => !option.disabled).length < 2;
  listEpisodes();
}

function listEpisodes() {
  const [, holds] = FILTERS[byId("filter").value];
  now.listed = [...now.reading.numbers.keys()].filter(holds);
  byId("episode").replaceChildren(...now.listed.map((episode) => new Option(now.reading.numbers[episode], episode)));
  for (const row of all("tr[data-episode]")) {
    const { length } = now.reading.numbers; // of those beyond, nothing but the row is here
    row.hidden = Number(row.dataset.episode) < length && !now.listed.includes(Number(row.dataset.episode));
  }
}

function filterEpisodes() {
  listEpisodes();
  pickEpisode(now.listed.includes(now.episode) ? now.episode : now.listed[0]);
}

function switchReading(name) {
  const at = span()[0] + now.frame; // the same frame of the dataset, whatever episode it is in
  chooseReading(name);
  const episode = episodeAt(at);
  chooseEpisode(episode, at - now.reading.episodes[episode][0]);
  if (playing) playing = { frame: now.frame, since: performance.now() };
  byId("said").textContent = now.reading.said;
}

const episodeAt = (at, { episodes } = now.reading) => episodes.findIndex(([from, to]) => from <= at && at < to);

function chooseEpisode(episode, frame = 0) {
  now.episode = episode;
  if (!now.listed.includes(episode)) {
    byId("filter").value = "all"; // whoever goes to an episode wants to see it
    listEpisodes();
  }
  byId("episode").value = episode;
  byId("previous").disabled = now.listed[0] === episode;
  byId("next").disabled = now.listed.at(-1) === episode;
  byId("frame").max = nFrames() - 1;
  const reached = now.reading.reached?.[episode];
  const verdict = { true: ", reached", false: ", not reached" }[reached] ?? "";
  const stored = { true: ", stored: success", false: ", stored: no success" }[now.reading.stored?.[episode]] ?? "";
  const [from, to] = now.reading.episodes[episode];
  const cut = nFrames() < to - from ? `the first ${nFrames().toLocaleString("en")} of ` : "";
  byId("verdict").textContent = `${cut}${(to - from).toLocaleString("en")} frames${verdict}${stored}`;
  for (const here of all(".here")) {
    here.setAttribute("x", `${(100 * from) / page.total}%`);
    here.setAttribute("width", `${(100 * (to - from)) / page.total}%`);
  }
  for (const row of all("tr[data-episode]")) row.classList.toggle("chosen", Number(row.dataset.episode) === episode);
  drawGoals();
  if (scene) drawPaths();
  drawCharts();
  chooseFrame(frame);
}

/** The episode that comes so many after this one among those that are listed. */
const neighbour = (step) => now.listed[now.listed.indexOf(now.episode) + step] ?? now.episode;

function chooseFrame(frame) {
  now.frame = Math.min(Math.max(frame, 0), nFrames() - 1);
  if (drawing) return; // keys can repeat faster than the screen is drawn
  drawing = true;
  requestAnimationFrame(drawFrame);
}

// --- the address -----------------------------------------------------------------------------------------------------

let writing = 0;

/** Write down what is looked at, once it stays: browsers refuse to be told too often, and a notebook at all. */
function writeAddress() {
  clearTimeout(writing);
  if (location.protocol !== "about:") writing = setTimeout(() => history.replaceState(null, "", address()), 300);
}

function address() {
  const reading = now.reading === right ? "" : `&reading=${now.reading.name}`;
  return `#episode=${now.reading.numbers[now.episode]}&frame=${now.frame}${reading}`;
}

/** Go to where an address says, as far as it is on the page; say whether it is. */
function go(hash) {
  const asked = new URLSearchParams(hash.slice(1));
  const reading = page.readings.find(({ name }) => name === asked.get("reading")) ?? now.reading;
  const episode = reading.numbers.indexOf(Number(asked.get("episode") ?? NaN));
  if (episode < 0) return false;
  stop();
  if (reading !== now.reading) chooseReading(reading.name);
  chooseEpisode(episode, Number.parseInt(asked.get("frame")) || 0);
  return true;
}

function follow(event) {
  const link = event.target.closest("a[href^='#episode=']") ?? event.target.closest("tr[data-episode]")?.querySelector("a");
  if (!link) return;
  event.preventDefault();
  if (go(link.getAttribute("href"))) byId("player").scrollIntoView({ block: "nearest" });
}

// --- traces --------------------------------------------------------------------------------------------------------

function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** Draw lines over an episode on one scale, in percent of the height, with the band of values that are within limits. */
function makeTrace(figure, label, kinds) {
  const shade = svg("rect", { class: "band", width: "100%" });
  const lines = kinds.map((kind) => svg("polyline", { class: `line ${kind}` }));
  const cursor = svg("line", { class: "cursor", y1: 0, y2: "100%" });
  const dots = kinds.map((kind) => svg("circle", { class: `dot ${kind}`, r: 4.5 }));
  const stretched = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none" }, ...lines);
  const [axis, marks] = [svg("g", { class: "axis" }), svg("g")];
  const hover = svg("line", { class: "hover", y1: 0, y2: "100%", visibility: "hidden" });
  const plot = svg("svg", { class: "plot", role: "img", "aria-label": label }, axis, shade, marks, stretched, hover, cursor, ...dots);
  const readout = document.createElement("output");
  const area = document.createElement("div");
  area.className = "area";
  area.append(plot, readout);
  figure.append(area);
  scrubWith(plot);
  const place = (frame) => `${nFrames() > 1 ? (100 * frame) / (nFrames() - 1) : 0}%`;
  let scale;
  let drawn = [];
  let unit = "";
  const read = (frame) => drawn.map((values) => `${short(values[frame])} ${unit}`.trim()).join(" / ");
  plot.addEventListener("pointermove", (event) => {
    const frame = frameUnder(plot, event);
    for (const end of ["x1", "x2"]) hover.setAttribute(end, place(frame));
    hover.setAttribute("visibility", "visible");
    readout.textContent = `${(frame / page.fps).toFixed(2)} s: ${read(frame)}`;
    readout.classList.toggle("left", frame > nFrames() / 2);
  });
  plot.addEventListener("pointerleave", () => {
    hover.setAttribute("visibility", "hidden");
    readout.textContent = "";
  });
  return {
    setEpisode(values, [bottom, top], ofWhat, { band = null, said = "", edge = null } = {}) {
      [drawn, unit] = [values, ofWhat];
      scale = (value) => (top > bottom ? 94 - (88 * (value - bottom)) / (top - bottom) : 50);
      lines.forEach((line, i) => line.setAttribute("points", thinned(values[i], scale)));
      const [from, to] = band ?? [bottom, bottom];
      shade.setAttribute("y", `${scale(to)}%`);
      shade.setAttribute("height", `${scale(from) - scale(to)}%`);
      const levels = (top > bottom ? [top, bottom] : [top]).filter((value) => Math.abs(scale(value) - scale(edge ?? NaN)) > 15 || edge === null);
      if (edge !== null) levels.push(edge);
      const across = (value) => svg("line", { class: "zero", x2: "100%", y1: `${scale(value)}%`, y2: `${scale(value)}%` });
      axis.replaceChildren(
        ...(bottom < 0 && top > 0 ? [across(0)] : []),
        ...levels.map((value) => text(short(value), { class: "level", x: -6, y: `${scale(value)}%`, dy: "0.35em" })),
        ...(edge === null ? [] : [text(said, { class: "limit", dx: 5, y: `${scale(edge)}%`, dy: -4 })]),
        ...ticks((nFrames() - 1) / page.fps).map((second, i) =>
          text(i ? second : `${second} s`, { class: "tick", x: place(second * page.fps), y: "100%", dy: 14 }),
        ),
      );
      const [first, last] = span();
      marks.replaceChildren(
        ...page.findings
          .filter(({ at }) => at !== null && first <= at && at < last)
          .map(({ at, severity }) =>
            svg("line", { class: `found ${severity}`, x1: place(at - first), x2: place(at - first), y2: "100%" }),
          ),
      );
    },
    setFrame(frame) {
      for (const end of ["x1", "x2"]) cursor.setAttribute(end, place(frame));
      dots.forEach((dot, i) => {
        const value = drawn[i][frame];
        dot.setAttribute("cx", place(frame));
        dot.setAttribute("visibility", Number.isFinite(value) ? "visible" : "hidden");
        if (Number.isFinite(value)) dot.setAttribute("cy", `${scale(value)}%`);
      });
    },
  };
}

function text(content, attributes) {
  const element = svg("text", attributes);
  element.textContent = content;
  return element;
}

/** Round numbers from 0 to an end, three to six of them. */
function ticks(end) {
  if (!(end > 0)) return [0];
  const power = 10 ** Math.floor(Math.log10(end / 3));
  const step = power * ([5, 2].find((factor) => end / (factor * power) >= 2.5) ?? 1);
  return Array.from({ length: Math.floor(end / step + 1e-9) + 1 }, (_, i) => Number((i * step).toPrecision(6)));
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

function frameUnder(plot, event) {
  const box = plot.getBoundingClientRect();
  const share = (event.clientX - box.left) / box.width;
  return Math.round(Math.min(Math.max(share, 0), 1) * (nFrames() - 1));
}

function scrubWith(plot) {
  const scrub = (event) => event.buttons === 1 && pickFrame(frameUnder(plot, event));
  plot.addEventListener("pointerdown", scrub);
  plot.addEventListener("pointermove", scrub);
}

// --- goals -----------------------------------------------------------------------------------------------------------

const goalFigures = all(".trace.goal");
const goalTraces = goalFigures.map((figure, i) => makeTrace(figure, `${right.goals[i].label} over time`, ["measured"]));

function drawGoals() {
  for (const [i, goal] of now.reading.goals.entries()) {
    const values = columns[goal.column].subarray(...span());
    const finite = values.filter(Number.isFinite);
    const [low, high] = goal.band ?? [null, null];
    const extreme = (choose) => finite.reduce((a, b) => choose(a, b), choose(0, high ?? low ?? 0));
    const bottom = extreme(Math.min);
    const top = goal.isAngle ? Math.PI : Math.max(extreme(Math.max), 2 * (high ?? 0), 2 * (low ?? 0));
    const band = goal.band && [Math.max(low ?? bottom, bottom), high ?? top];
    goalTraces[i].setEpisode([values], [bottom, top], goal.unit, { band, said: goal.limit, edge: high ?? low });
  }
}

function drawGoal(i, at) {
  const goal = now.reading.goals[i];
  const value = columns[goal.column][at];
  const within = Boolean((held[i][at >> 3] >> (7 - (at & 7))) & 1);
  const mark = goalFigures[i].querySelector(".mark");
  goalTraces[i].setFrame(now.frame);
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

// --- every dimension: a joint and its command in one chart ------------------------------------------------------------

let charts = [];

function makeCharts() {
  const chosen = page.charts.slice(now.firstChart, now.firstChart + CHARTS);
  charts = chosen.map((chart) => {
    const kinds = Object.keys(chart.series);
    const figure = element("figure", "trace");
    const caption = element("figcaption", "", element("b", "", chart.name));
    const values = kinds.map((kind) => {
      const value = element("span", `value ${kind}`);
      value.dataset.place = chart.series[kind];
      return value;
    });
    caption.append(" ", ...values, element("span", "unit", chart.unit));
    figure.append(caption);
    const digits = Math.min(Math.max(4 - Math.ceil(Math.log10(Math.max(...chart.ends.map(Math.abs)) || 1)), 0), 8);
    const trace = makeTrace(figure, `${chart.group}: ${chart.name} over time`, kinds);
    return { ...chart, figure, trace, values, digits, columns: kinds.map((kind) => columns[chart.series[kind]]) };
  });
  const parts = charts.flatMap(({ group, figure }, i) =>
    group === charts[i - 1]?.group ? [figure] : [element("h4", "", group), figure],
  );
  byId("plots").replaceChildren(...parts);
  const last = now.firstChart + chosen.length;
  byId("pager").hidden = page.charts.length <= CHARTS;
  byId("which").textContent = `charts ${now.firstChart + 1} to ${last} of ${page.charts.length}`;
  byId("fewer").disabled = now.firstChart === 0;
  byId("more").disabled = last === page.charts.length;
}

function element(name, className, ...children) {
  const made = document.createElement(name);
  made.className = className;
  made.append(...children);
  return made;
}

function drawCharts() {
  const ofEpisode = all("#scale input").some((radio) => radio.checked && radio.value === "episode");
  for (const { trace, columns: drawn, ends, unit } of charts) {
    const values = drawn.map((column) => column.subarray(...span()));
    trace.setEpisode(values, ofEpisode || ends.includes(null) ? endsOf(values) : ends, unit);
  }
}

function endsOf(values) {
  const finite = values.flatMap((column) => [...column.filter(Number.isFinite)]);
  return [Math.min, Math.max].map((choose) => finite.reduce((a, b) => choose(a, b), finite[0] ?? 0));
}

function turnPage(step) {
  now.firstChart += step * CHARTS;
  makeCharts();
  drawCharts();
  chooseFrame(now.frame);
}

// --- the cameras ------------------------------------------------------------------------------------------------------

const films = all(".camera").map((figure, i) => makeFilm(figure, page.cameras[i]));

/** A camera, whose clip shows the frame that is looked at; while it plays, the clip leads. */
function makeFilm(figure, { clips, missing }) {
  const [video, note] = [figure.querySelector("video"), figure.querySelector(".missing")];
  let loaded = null; // the episode of the clip
  const why = () => {
    if (!clips[loaded]) return missing;
    if (video.error) return `This browser cannot play the clip: ${video.error.message || "its codec is unknown here"}.`;
    return inClip() ? "" : `The page has room for the first ${clips[loaded][2].toLocaleString("en")} frames of this clip only.`;
  };
  let frame = 0; // of the episode
  const inClip = () => clips[loaded] && !video.error && frame < clips[loaded][2];
  const tell = () => {
    note.textContent = why();
    note.hidden = !note.textContent;
    video.hidden = Boolean(note.textContent);
  };
  video.addEventListener("error", tell);
  return {
    show(episode, at) {
      frame = at;
      if (episode !== loaded) {
        loaded = episode;
        if (video.src) URL.revokeObjectURL(video.src);
        if (clips[episode]) video.src = URL.createObjectURL(new Blob([bytesOf(clips[episode][0])], { type: "video/mp4" }));
        else video.removeAttribute("src");
      }
      tell();
      if (!inClip()) return;
      const time = clips[loaded][1] + (frame + 0.5) / page.fps; // the middle of a frame, whatever is rounded
      const isOff = Math.abs(video.currentTime - time) > (playing ? 0.25 : 1e-3);
      if (isOff) video.currentTime = time;
      if (playing && video.paused) {
        video.playbackRate = speed();
        video.play().catch(() => {}); // the clock goes on without it
      } else if (!playing) video.pause();
    },
    /** Which frame of the episode is on the screen; nothing where the clip does not run. */
    frame() {
      const runs = inClip() && !video.paused && !video.ended && !video.seeking && video.readyState > 2;
      return runs ? Math.floor((video.currentTime - clips[loaded][1]) * page.fps) : null;
    },
  };
}

function drawFilms(at) {
  const episode = episodeAt(at, right);
  for (const film of films) film.show(episode, at - right.episodes[episode][0]);
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
  for (const { trace, columns: drawn, values, digits } of charts) {
    trace.setFrame(now.frame);
    values.forEach((value, i) => (value.textContent = drawn[i][at].toFixed(digits)));
  }
  if (films.length) drawFilms(at);
  if (!playing) writeAddress();
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

const speed = () => Number(byId("speed").value);

function advance(time) {
  if (!playing) return;
  const shown = films.map((film) => film.frame()).find((frame) => frame !== null);
  if (shown === undefined) {
    const due = playing.frame + Math.max(0, Math.floor(((time - playing.since) / 1000) * speed() * page.fps));
    if (due > now.frame) chooseFrame(due);
  } else {
    const from = right.episodes[episodeAt(span()[0] + now.frame, right)][0] - span()[0]; // boundaries may be dropped
    if (from + shown > now.frame) chooseFrame(from + shown);
    playing = { frame: now.frame, since: time };
  }
  if (now.frame === nFrames() - 1) pickFrame(now.frame);
  else requestAnimationFrame(advance);
}

const toggle = () => (playing ? stop() : play());

function onKey(event) {
  const inPlayer = event.target === document.body || byId("player").contains(event.target);
  if (!inPlayer || event.target.tagName === "SELECT" || event.altKey || event.ctrlKey || event.metaKey) return;
  const step = event.shiftKey ? 10 : 1;
  const targets = { ArrowLeft: now.frame - step, ArrowRight: now.frame + step, Home: 0, End: nFrames() - 1 };
  const episodes = { ArrowUp: -1, ArrowDown: 1 };
  if (event.key in targets) pickFrame(targets[event.key]);
  else if (event.key in episodes) pickEpisode(neighbour(episodes[event.key]));
  else if (event.key === " " && event.target.tagName !== "BUTTON") toggle();
  else return;
  event.preventDefault();
}

function pickInRibbon(event) {
  const box = event.currentTarget.getBoundingClientRect();
  const at = ((event.clientX - box.left) / box.width) * page.total;
  const episode = episodeAt(at);
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
byId("previous").addEventListener("click", () => pickEpisode(neighbour(-1)));
byId("next").addEventListener("click", () => pickEpisode(neighbour(1)));
byId("frame").addEventListener("input", (event) => pickFrame(Number(event.target.value)));
byId("play").addEventListener("click", toggle);
byId("speed").addEventListener("change", () => {
  const wasPlaying = Boolean(playing);
  pickFrame(now.frame);
  if (wasPlaying) play();
});
byId("filter").addEventListener("change", filterEpisodes);
byId("scale").addEventListener("change", () => {
  drawCharts();
  chooseFrame(now.frame);
});
byId("fewer").addEventListener("click", () => turnPage(-1));
byId("more").addEventListener("click", () => turnPage(1));
for (const ribbon of all(".ribbon")) ribbon.addEventListener("click", pickInRibbon);
document.addEventListener("click", follow);
document.addEventListener("keydown", onKey);
window.addEventListener("hashchange", () => go(location.hash));

byId("scale").hidden = false;
makeCharts();
chooseReading(right.name);
if (!go(location.hash)) chooseEpisode(0);
