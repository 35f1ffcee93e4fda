"use strict";
// The panel. It decodes nothing: positions, yaws, errors and whether they are within their limits come with the page,
// worked out by the package. Names from the dataset are written with textContent only, so that none is ever taken for
// markup.

/** @type {<Id extends keyof Ids>(id: Id) => Ids[Id]} */
const byId = (id) => /** @type {any} */ (document.getElementById(id));
/** @type {<Part extends Element = HTMLElement>(selector: string) => Part[]} */
const all = (selector) => [.../** @type {NodeListOf<any>} */ (document.querySelectorAll(selector))];
/** @type {PageData} */
const page = JSON.parse(byId("data").textContent);
/** @param {string} text */
const bytesOf = (text) => Uint8Array.from(atob(text), (char) => char.charCodeAt(0));
const columns = decodeColumns(page);
const CHARTS = 24; // that are drawn at once

/** @type {Uint8Array[]} */
let held = []; // a bit for each goal and frame: whether it is within its limits
const right = page.readings[0];
const CLOSEST = 10; // frames
/** @type {Record<string, number>} */
const ZOOMS = { "+": 1 / 2, "=": 1 / 2, "-": 2 };
/** @type {{reading: Reading, episode: number, frame: number, listed: number[], firstChart: number}} */
const now = { reading: right, episode: 0, frame: 0, listed: [], firstChart: 0 };
/** @type {{frame: number, since: number} | null} */
let playing = null; // since when, and from which frame on
let drawing = false;
/** @type {[number, number]} */
let zoom = [0, 1]; // from where to where in the episode the charts go

/**
 * @param {PageData} data
 * @returns {Values[]}
 */
function decodeColumns({ frames, bytes, shown }) {
  const raw = bytesOf(frames);
  const values = bytes === 8 ? new Float64Array(raw.buffer) : new Float32Array(raw.buffer);
  return Array.from({ length: values.length / shown }, (_, i) => values.subarray(i * shown, (i + 1) * shown));
}

// --- what is shown -------------------------------------------------------------------------------------------------

/**
 * First frame of the episode, and one past the last that the page holds.
 * @returns {[number, number]}
 */
const span = () => {
  const [from, to] = now.reading.episodes[now.episode];
  return [from, Math.min(to, page.shown)];
};
const nFrames = () => span()[1] - span()[0];

/**
 * Which episodes there are to choose from.
 * @type {Record<string, [string, (episode: number) => boolean]>}
 */
const FILTERS = {
  all: ["all episodes", () => true],
  missed: ["not reached", (episode) => now.reading.reached?.[episode] === false],
  failed: ["no success", (episode) => now.reading.stored?.[episode] === false],
  found: ["with findings", (episode) => hasEpisodes() && numbersFound.has(now.reading.numbers[episode])],
};
const numbersFound = new Set(page.findings.flatMap((finding) => finding.episodes));
const hasEpisodes = () => now.reading.episodes.length === right.episodes.length;
/** @type {HTMLInputElement[]} */
const readingRadios = all("#switch input");

/** @param {Reading} reading */
function chooseReading(reading) {
  now.reading = reading;
  held = now.reading.goals.map((goal) => bytesOf(goal.held));
  for (const part of all("[data-reading]")) part.hidden = part.dataset.reading !== reading.name;
  for (const radio of readingRadios) radio.checked = radio.value === reading.name;
  for (const code of all("[data-formula]")) {
    const pose = code.dataset.formula ?? "";
    code.textContent = reading.formulas[pose];
    code.classList.toggle("changed", reading.formulas[pose] !== right.formulas[pose]);
  }
  document.body.classList.toggle("wrong", reading !== right);
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
  byId("episode").replaceChildren(
    ...now.listed.map((episode) => new Option(`${now.reading.numbers[episode]}`, `${episode}`)),
  );
  for (const row of all("tr[data-episode]")) {
    const { length } = now.reading.numbers; // of those beyond, nothing but the row is here
    row.hidden = Number(row.dataset.episode) < length && !now.listed.includes(Number(row.dataset.episode));
  }
}

function filterEpisodes() {
  listEpisodes();
  pickEpisode(now.listed.includes(now.episode) ? now.episode : now.listed[0]);
}

/** @param {Reading} reading */
function switchReading(reading) {
  const at = span()[0] + now.frame; // the same frame of the dataset, whatever episode it is in
  chooseReading(reading);
  const episode = episodeAt(at);
  chooseEpisode(episode, at - now.reading.episodes[episode][0]);
  if (playing) playing = { frame: now.frame, since: performance.now() };
  byId("said").textContent = reading.said ?? "";
}

/** @param {number} at */
const episodeAt = (at, { episodes } = now.reading) => episodes.findIndex(([from, to]) => from <= at && at < to);

/** @param {number} episode */
function chooseEpisode(episode, frame = 0) {
  now.episode = episode;
  zoom = [0, 1];
  if (!now.listed.includes(episode)) {
    byId("filter").value = "all"; // whoever goes to an episode wants to see it
    listEpisodes();
  }
  byId("episode").value = `${episode}`;
  byId("previous").disabled = now.listed[0] === episode;
  byId("next").disabled = now.listed.at(-1) === episode;
  byId("frame").max = `${nFrames() - 1}`;
  const { reached, stored } = now.reading;
  const verdict = reached ? `, ${reached[episode] ? "" : "not "}reached` : "";
  const label = stored ? `, stored: ${stored[episode] ? "" : "no "}success` : "";
  const [from, to] = now.reading.episodes[episode];
  const cut = nFrames() < to - from ? `the first ${nFrames().toLocaleString("en")} of ` : "";
  byId("verdict").textContent = `${cut}${(to - from).toLocaleString("en")} frames${verdict}${label}`;
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

/**
 * The episode that comes so many after this one among those that are listed.
 * @param {number} step
 */
const neighbour = (step) => now.listed[now.listed.indexOf(now.episode) + step] ?? now.episode;

/** @param {number} frame */
function chooseFrame(frame) {
  now.frame = Math.min(Math.max(frame, 0), nFrames() - 1);
  if (!isInSight(now.frame)) zoomBy(1);
  if (drawing) return; // keys can repeat faster than the screen is drawn
  drawing = true;
  requestAnimationFrame(drawFrame);
}

// --- the address -----------------------------------------------------------------------------------------------------

/** @type {ReturnType<typeof setTimeout> | undefined} */
let writing;

/** Write down what is looked at, once it stays: browsers refuse to be told too often, and a notebook at all. */
function writeAddress() {
  clearTimeout(writing);
  if (location.protocol !== "about:") writing = setTimeout(() => history.replaceState(null, "", address()), 300);
}

function address() {
  const reading = now.reading === right ? "" : `&reading=${now.reading.name}`;
  return `#episode=${now.reading.numbers[now.episode]}&frame=${now.frame}${reading}`;
}

/**
 * Go to where an address says, as far as it is on the page; say whether it is.
 * @param {string} hash
 */
function go(hash) {
  const asked = new URLSearchParams(hash.slice(1));
  const reading = page.readings.find(({ name }) => name === asked.get("reading")) ?? now.reading;
  const episode = reading.numbers.indexOf(Number(asked.get("episode") ?? NaN));
  if (episode < 0) return false;
  stop();
  if (reading !== now.reading) chooseReading(reading);
  chooseEpisode(episode, Number.parseInt(asked.get("frame") ?? "", 10) || 0);
  return true;
}

/** @param {MouseEvent} event */
function follow(event) {
  const target = /** @type {Element} */ (event.target);
  /** @type {HTMLAnchorElement | null | undefined} */
  const link = target.closest("a[href^='#episode=']") ?? target.closest("tr[data-episode]")?.querySelector("a");
  if (!link) return;
  event.preventDefault();
  if (!go(link.hash)) return;
  byId("player").scrollIntoView({ block: "nearest" });
  byId("frame").focus({ preventScroll: true }); // so that the next key means its frames
}

// --- traces --------------------------------------------------------------------------------------------------------

/**
 * @param {string} name
 * @param {Record<string, string | number>} [attributes]
 * @param {Element[]} children
 */
function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, `${value}`);
  element.append(...children);
  return element;
}

/**
 * Draw lines over an episode on one scale, in percent of the height, with the band that is within limits.
 * @param {HTMLElement} figure
 * @param {string} label
 * @param {Kind[]} kinds
 * @param {number[]} [own] the columns that are drawn
 */
function makeTrace(figure, label, kinds, own = []) {
  const shade = svg("rect", { class: "band", width: "100%" });
  const lines = kinds.map((kind) => svg("polyline", { class: `line ${kind}` }));
  const cursor = svg("line", { class: "cursor", y1: 0, y2: "100%" });
  const dots = kinds.map((kind) => svg("circle", { class: `dot ${kind}`, r: 4.5 }));
  const stretched = svg("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none" }, ...lines);
  const [axis, marks] = [svg("g", { class: "axis" }), svg("g")];
  const hover = svg("line", { class: "hover", y1: 0, y2: "100%", visibility: "hidden" });
  const parts = [axis, shade, marks, stretched, hover, cursor, ...dots];
  const plot = svg("svg", { class: "plot", role: "img", "aria-label": label }, ...parts);
  const readout = document.createElement("output");
  const area = document.createElement("div");
  area.className = "area";
  area.append(plot, readout);
  figure.append(area);
  scrubWith(plot);
  const place = (/** @type {number} */ frame) => `${across(frame)}%`;
  /** @type {(value: number) => number} */
  let scale;
  /** @type {Values[]} */
  let drawn = [];
  let unit = "";
  const read = (/** @type {number} */ frame) =>
    drawn.map((values) => `${short(values[frame])} ${unit}`.trim()).join(" / ");
  plot.addEventListener("pointermove", (event) => {
    const frame = frameUnder(plot, event);
    for (const end of ["x1", "x2"]) hover.setAttribute(end, place(frame));
    hover.setAttribute("visibility", "visible");
    readout.textContent = `${(frame / page.fps).toFixed(2)} s: ${read(frame)}`;
    readout.classList.toggle("left", across(frame) > 50);
  });
  plot.addEventListener("pointerleave", () => {
    hover.setAttribute("visibility", "hidden");
    readout.textContent = "";
  });
  return {
    /**
     * @param {Values[]} values
     * @param {[number, number]} ends
     * @param {string} ofWhat
     * @param {{band?: [number, number] | null, said?: string, edge?: number | null}} [goal]
     */
    setEpisode(values, [bottom, top], ofWhat, { band = null, said = "", edge = null } = {}) {
      [drawn, unit] = [values, ofWhat];
      scale = (value) => (top > bottom ? 94 - (88 * (value - bottom)) / (top - bottom) : 50);
      for (const [i, line] of lines.entries()) line.setAttribute("points", thinned(values[i], scale));
      const [from, to] = band ?? [bottom, bottom];
      shade.setAttribute("y", `${scale(to)}%`);
      shade.setAttribute("height", `${scale(from) - scale(to)}%`);
      axis.replaceChildren(...axisParts({ scale, place, bottom, top, edge, said, values: values[0] }));
      marks.replaceChildren(...findingMarks(place, own));
    },
    /** @param {number} frame */
    setFrame(frame) {
      for (const end of ["x1", "x2"]) cursor.setAttribute(end, place(frame));
      for (const [i, dot] of dots.entries()) {
        const value = drawn[i][frame];
        dot.setAttribute("cx", place(frame));
        dot.setAttribute("visibility", Number.isFinite(value) ? "visible" : "hidden");
        if (Number.isFinite(value)) dot.setAttribute("cy", `${scale(value)}%`);
      }
    },
  };
}

/**
 * A line wherever a finding about one of these columns, or about whole frames, is in this episode.
 * @param {(frame: number) => string} place
 * @param {number[]} own
 */
function* findingMarks(place, own) {
  const [first, last] = span();
  for (const { at, columns: about, severity } of page.findings) {
    if (at === null || at < first || last <= at) continue;
    if (about && !about.some((column) => own.includes(column))) continue;
    if (!isInSight(at - first)) continue;
    const x = place(at - first);
    yield svg("line", { class: `found ${severity}`, x1: x, x2: x, y2: "100%" });
  }
}

/**
 * The zero line, the ends of the scale, the edge of a goal with what it says, and round seconds.
 * @param {{
 *   scale: (value: number) => number, place: (frame: number) => string, bottom: number, top: number,
 *   edge: number | null, said: string, values: Values,
 * }} parts
 */
function axisParts({ scale, place, bottom, top, edge, said, values }) {
  const far = (/** @type {number} */ value) => Math.abs(scale(value) - scale(edge ?? 0));
  const ends = top > bottom ? [top, bottom] : [top];
  const levels = edge === null ? ends : [...ends.filter((end) => far(end) > 15), edge];
  const digits = Math.min(Math.max(2 - Math.floor(Math.log10(top - bottom || 1)), 0), 9);
  const parts = levels.map((value) =>
    text(Number(value.toFixed(digits)) + 0, { class: "level", x: -6, y: `${scale(value)}%`, dy: "0.35em" }),
  );
  const zero = `${scale(0)}%`;
  if (bottom < 0 && top > 0) parts.unshift(svg("line", { class: "zero", x2: "100%", y1: zero, y2: zero }));
  if (edge !== null) {
    // At the end where the line is out of the way.
    const [side, x, dx] = far(values[0]) >= far(values[values.length - 1]) ? ["left", 0, 5] : ["right", "100%", -4];
    parts.push(text(said, { class: `limit ${side}`, x, dx, y: `${scale(edge)}%`, dy: -4 }));
  }
  const seconds = zoom.map((share) => (share * (nFrames() - 1)) / page.fps);
  for (const [i, second] of ticks(seconds[0], seconds[1]).entries()) {
    parts.push(text(i ? second : `${second} s`, { class: "tick", x: place(second * page.fps), y: "100%", dy: 14 }));
  }
  return parts;
}

/**
 * @param {string | number} content
 * @param {Record<string, string | number>} attributes
 */
function text(content, attributes) {
  const element = svg("text", attributes);
  element.textContent = `${content}`;
  return element;
}

/**
 * Round numbers from a start to an end, three to six of them.
 * @param {number} start
 * @param {number} end
 */
function ticks(start, end) {
  if (!(end > start)) return [0];
  const power = 10 ** Math.floor(Math.log10((end - start) / 3));
  const step = power * ([5, 2].find((factor) => (end - start) / (factor * power) >= 2.5) ?? 1);
  const first = Math.ceil(start / step - 1e-9);
  const n = Math.floor(end / step + 1e-9) - first + 1;
  return Array.from({ length: n }, (_, i) => Number(((first + i) * step).toPrecision(6)));
}

/**
 * The points of a line; of a long one, the least and the greatest value in each of 600 pieces.
 * @param {Values} values
 * @param {(value: number) => number} scale
 */
function thinned(values, scale) {
  const step = Math.max(1, Math.ceil(values.length / 600));
  const points = [];
  for (let start = 0; start < values.length; start += step) {
    const piece = values.subarray(start, start + step).filter(Number.isFinite);
    if (!piece.length) continue;
    const ends = step === 1 ? [piece[0]] : [Math.min(...piece), Math.max(...piece)];
    for (const value of ends) points.push(`${across(start)},${scale(value)}`);
  }
  return points.join(" ");
}

/** @param {number} value */
const short = (value) => (Number.isInteger(value) ? value : Number(value.toPrecision(3)));

/**
 * @param {Element} plot
 * @param {MouseEvent} event
 */
function frameUnder(plot, event) {
  const box = plot.getBoundingClientRect();
  const share = (event.clientX - box.left) / box.width;
  const [from, to] = zoom;
  return Math.round((from + Math.min(Math.max(share, 0), 1) * (to - from)) * (nFrames() - 1));
}

/**
 * Where a frame is, in percent of the width of a chart.
 * @param {number} frame
 */
function across(frame) {
  const [from, to] = zoom;
  return nFrames() > 1 ? (100 * (frame / (nFrames() - 1) - from)) / (to - from) : 0;
}

/** @param {number} frame */
function isInSight(frame) {
  return across(frame) > -1e-6 && across(frame) < 100 + 1e-6;
}

/**
 * Show a part of the episode in the charts, so many times as long as now, around a frame.
 * @param {number} times
 * @param {number} [around]
 */
function zoomBy(times, around = now.frame) {
  const last = Math.max(nFrames() - 1, 1);
  const width = Math.min(Math.max((zoom[1] - zoom[0]) * times, Math.min(CLOSEST / last, 1)), 1);
  const from = Math.min(Math.max(around / last - width / 2, 0), 1 - width);
  zoom = [from, from + width];
  drawGoals();
  drawCharts();
}

/** @param {SVGElement} plot */
function scrubWith(plot) {
  const scrub = (/** @type {PointerEvent} */ event) => event.buttons === 1 && pickFrame(frameUnder(plot, event));
  plot.addEventListener("dblclick", (event) => {
    zoomBy(zoom[1] - zoom[0] < 1 ? 1 / (zoom[1] - zoom[0]) : 1 / 4, frameUnder(plot, event));
    pickFrame(now.frame);
  });
  plot.addEventListener("pointerdown", scrub);
  plot.addEventListener("pointermove", scrub);
}

// --- goals -----------------------------------------------------------------------------------------------------------

const goalFigures = all(".trace.goal");
const goalTexts = goalFigures.map((figure) => [...figure.querySelectorAll(".value, .mark")]);
const goalTraces = goalFigures.map((figure, i) => makeTrace(figure, `${right.goals[i].label} over time`, ["measured"]));

function drawGoals() {
  for (const [i, goal] of now.reading.goals.entries()) {
    const values = columns[goal.column].subarray(...span());
    const [low, high] = goal.band ?? [null, null];
    const edge = high ?? low;
    const [bottom, most] = endsOf([values], [0, edge ?? 0]);
    const top = goal.isAngle ? Math.PI : Math.max(most, 2 * (high ?? 0), 2 * (low ?? 0));
    /** @type {[number, number] | null} */
    const band = goal.band && [Math.max(low ?? bottom, bottom), high ?? top];
    goalTraces[i].setEpisode([values], [bottom, top], goal.unit, { band, said: goal.limit, edge });
  }
}

/**
 * @param {number} i
 * @param {number} at
 */
function drawGoal(i, at) {
  const goal = now.reading.goals[i];
  const value = columns[goal.column][at];
  const within = Boolean((held[i][at >> 3] >> (7 - (at & 7))) & 1);
  const [number, mark] = goalTexts[i];
  goalTraces[i].setFrame(now.frame);
  number.textContent = goal.isAngle ? angle(value) : `${value.toFixed(4)} ${goal.unit}`;
  mark.textContent = `${within ? "\u2713" : "\u2717 not"} ${goal.limit}`;
  mark.classList.toggle("within", within);
}

/** @param {number} radians */
const degrees = (radians) => (radians * 180) / Math.PI;
/** @param {number} radians */
const angle = (radians) => `${radians.toFixed(4)} rad = ${degrees(radians).toFixed(1)}\u00b0`;

// --- the world -------------------------------------------------------------------------------------------------------

const scene = byId("scene");
/** @type {(selector: string) => [SVGElement, string][]} */
const posed = (selector) => {
  /** @type {SVGElement[]} */
  const parts = all(`#scene ${selector}`);
  return parts.map((part) => [part, part.dataset.pose ?? ""]);
};
const bodies = posed(".body");
const trails = posed(".path");
const trailsAhead = posed(".ahead");
const [arrow] = all("#scene .action");
/** @type {Record<string, string[]>} */
const points = {}; // of each body that moves, in this episode

function drawPaths() {
  const [from, to] = span();
  for (const [line, pose] of trailsAhead) {
    const [x, y] = now.reading.poses[pose].map((column) => columns[column ?? 0]);
    points[pose] = [...x.subarray(from, to)].map((value, i) => `${value},${y[from + i]}`);
    line.setAttribute("points", points[pose].slice(0, page.longestPath).join(" "));
  }
}

/** @param {number} at */
function drawWorld(at) {
  for (const [body, pose] of bodies) {
    const [x, y, yaw] = now.reading.poses[pose].map((column) => (column === null ? 0 : columns[column][at]));
    body.setAttribute("transform", `translate(${x} ${y}) rotate(${degrees(yaw)})`);
  }
  for (const [line, pose] of trails) {
    const path = points[pose].slice(Math.max(0, now.frame + 1 - page.longestPath), now.frame + 1);
    line.setAttribute("points", path.join(" "));
  }
  arrow.setAttribute("d", arrowPath(at));
}

/**
 * From the body that the action drives to where it would take it in one frame.
 * @param {number} at
 */
function arrowPath(at) {
  if (!now.reading.action) return "";
  const { pose, columns: driven, scale, isPlace } = now.reading.action;
  const [x, y] = now.reading.poses[pose].map((column) => columns[column ?? 0][at]);
  const [askedX, askedY] = driven.map((column) => scale * columns[column][at]);
  const [dx, dy] = isPlace ? [askedX - x, askedY - y] : [askedX, askedY];
  const length = Math.hypot(dx, dy);
  if (!(length > 0.0025 * reach)) return "";
  const head = Math.min(0.03 * reach, length / 2) / length;
  const [tipX, tipY] = [x + dx, y + dy];
  const barb = (/** @type {number} */ side) =>
    `${tipX - head * (dx - side * 0.6 * dy)} ${tipY - head * (dy + side * 0.6 * dx)}`;
  return `M${x} ${y}L${tipX} ${tipY}M${barb(1)}L${tipX} ${tipY}L${barb(-1)}`;
}

// Half the width of the picture, in the unit of the positions.
const reach = 410 / Number(/scale\(([^ ]+)/.exec(scene?.innerHTML ?? "")?.[1] ?? 410);

// --- every dimension: a joint and its command in one chart -----------------------------------------------------------

/** @type {ReturnType<typeof makeChart>[]} */
let charts = [];

/** @param {Chart} chart */
function makeChart(chart) {
  const series = /** @type {[Kind, number][]} */ (Object.entries(chart.series));
  const figure = element("figure", "trace");
  const caption = element("figcaption", "", element("b", "", chart.name));
  const values = series.map(([kind, column]) => {
    const value = element("span", `value ${kind}`);
    value.dataset.place = `${column}`;
    return value;
  });
  caption.append(" ", ...values, element("span", "unit", chart.unit));
  figure.append(caption);
  const greatest = Math.max(...chart.ends.map((end) => Math.abs(end ?? 0)));
  const digits = Math.min(Math.max(4 - Math.ceil(Math.log10(greatest || 1)), 0), 8);
  const [kinds, own] = [series.map(([kind]) => kind), series.map(([, column]) => column)];
  const trace = makeTrace(figure, `${chart.group}: ${chart.name} over time`, kinds, own);
  return { ...chart, figure, trace, values, digits, columns: own.map((column) => columns[column]) };
}

function makeCharts() {
  charts = page.charts.slice(now.firstChart, now.firstChart + CHARTS).map(makeChart);
  const parts = charts.flatMap(({ group, figure }, i) =>
    group === charts[i - 1]?.group ? [figure] : [element("h4", "", group), figure],
  );
  byId("plots").replaceChildren(...parts);
  const last = now.firstChart + charts.length;
  byId("pager").hidden = page.charts.length <= CHARTS;
  byId("which").textContent = `charts ${now.firstChart + 1} to ${last} of ${page.charts.length}`;
  byId("fewer").disabled = now.firstChart === 0;
  byId("more").disabled = last === page.charts.length;
}

/**
 * @param {string} name
 * @param {string} className
 * @param {(Node | string)[]} children
 */
function element(name, className, ...children) {
  const made = document.createElement(name);
  made.className = className;
  made.append(...children);
  return made;
}

function drawCharts() {
  const ofEpisode = Boolean(byId("scale").querySelector("[value=episode]:checked"));
  for (const { trace, columns: drawn, ends, unit } of charts) {
    const values = drawn.map((column) => column.subarray(...span()));
    const [low, high] = ends;
    trace.setEpisode(values, ofEpisode || low === null || high === null ? endsOf(values) : [low, high], unit);
  }
}

/**
 * The least and the greatest of all values that are numbers, and of what must be in sight.
 * @param {Values[]} values
 * @param {number[]} also
 * @returns {[number, number]}
 */
function endsOf(values, also = []) {
  let [low, high] = [Math.min(...also), Math.max(...also)];
  for (const column of values) {
    for (const value of column) {
      if (!Number.isFinite(value)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 0];
}

/** @param {number} step */
function turnPage(step) {
  now.firstChart += step * CHARTS;
  makeCharts();
  drawCharts();
  chooseFrame(now.frame);
}

// --- the cameras -----------------------------------------------------------------------------------------------------

const films = all(".camera").map((figure, i) => {
  const film = page.cameras[i];
  return film.pictures.length ? makeSlides(figure, film) : makeFilm(figure, film);
});

/** @type {Record<number, string>} */
const WHY_NOT = { [MediaError.MEDIA_ERR_SRC_NOT_SUPPORTED]: "it has no decoder for it, or the clip is broken" };

/**
 * A camera, whose clip shows the frame that is looked at; while it plays, the clip leads.
 * @param {HTMLElement} figure
 * @param {Film} film
 */
function makeFilm(figure, { clips, missing }) {
  const video = /** @type {HTMLVideoElement} */ (figure.querySelector("video"));
  const note = /** @type {HTMLElement} */ (figure.querySelector(".missing"));
  let loaded = -1; // the episode of the clip
  const why = () => {
    if (!clips[loaded]) return missing;
    if (video.error) return `This browser cannot play the clip: ${WHY_NOT[video.error.code] ?? video.error.message}.`;
    return inClip() ? "" : `Of this clip, the page has room for the first ${clips[loaded][2]} frames only.`;
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
    /**
     * @param {number} episode
     * @param {number} at
     */
    show(episode, at) {
      frame = at;
      if (episode !== loaded) {
        loaded = episode;
        if (video.src) URL.revokeObjectURL(video.src);
        const clip = clips[episode] && new Blob([bytesOf(clips[episode][0])], { type: "video/mp4" });
        if (clip) video.src = URL.createObjectURL(clip);
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

/**
 * A camera of which the page holds some pictures: the last one up to the frame that is looked at is shown.
 * @param {HTMLElement} figure
 * @param {Film} film
 */
function makeSlides(figure, { pictures, missing }) {
  const [image] = /** @type {HTMLCollectionOf<HTMLImageElement>} */ (figure.getElementsByTagName("img"));
  const note = /** @type {HTMLElement} */ (figure.querySelector(".missing"));
  const which = /** @type {HTMLElement} */ (figure.querySelector(".which"));
  let loaded = -2; // which picture, or -1 for none
  const tell = (/** @type {string} */ why) => {
    note.textContent = why;
    note.hidden = !why;
    image.hidden = Boolean(why);
  };
  image.addEventListener("error", () => tell("This browser cannot show the picture."));
  return {
    /**
     * @param {number} episode
     * @param {number} at
     */
    show(episode, at) {
      const first = right.episodes[episode][0];
      const last = pictures.findLastIndex(([frame]) => first <= frame && frame <= first + at);
      if (last === loaded) return;
      loaded = last;
      URL.revokeObjectURL(image.src);
      tell(last < 0 ? missing : "");
      which.textContent = last < 0 ? "" : `, frame ${pictures[last][0] - first}`;
      if (last < 0) return;
      const [, data, type] = pictures[last];
      image.src = URL.createObjectURL(new Blob([bytesOf(data)], { type }));
    },
    frame: () => null,
  };
}

/** @param {number} at */
function drawFilms(at) {
  const episode = episodeAt(at, right);
  for (const film of films) film.show(episode, at - right.episodes[episode][0]);
}

/** @type {[HTMLElement, Values][]} */
const cells = all("[data-column]").map((cell) => [cell, columns[Number(cell.dataset.column)]]);
const yaws = all("[data-yaw]");

// --- one frame -----------------------------------------------------------------------------------------------------

function drawFrame() {
  drawing = false;
  const at = span()[0] + now.frame;
  const seconds = (now.frame / page.fps).toFixed(1);
  const last = nFrames() - 1;
  byId("frame").value = `${now.frame}`;
  byId("frame").style.setProperty("--done", `${last ? (100 * now.frame) / last : 0}%`);
  byId("frame").setAttribute("aria-valuetext", `frame ${now.frame} of 0 to ${last}, ${seconds} seconds`);
  byId("clock").textContent = `frame ${now.frame} of 0\u2013${last}, ${seconds} s`;
  for (const i of now.reading.goals.keys()) drawGoal(i, at);
  for (const [cell, column] of cells) cell.textContent = column[at].toFixed(4);
  for (const cell of yaws) cell.textContent = angle(columns[now.reading.poses[cell.dataset.yaw ?? ""][2] ?? 0][at]);
  if (scene) drawWorld(at);
  for (const { trace, columns: drawn, values, digits } of charts) {
    trace.setFrame(now.frame);
    for (const [i, value] of values.entries()) value.textContent = drawn[i][at].toFixed(digits);
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

/** @param {number} time */
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

/** @param {KeyboardEvent} event */
function onKey(event) {
  const target = /** @type {Element} */ (event.target);
  const inPlayer = target === document.body || byId("player").contains(target);
  if (!inPlayer || target.tagName === "SELECT" || event.altKey || event.ctrlKey || event.metaKey) return;
  const step = event.shiftKey ? 10 : 1;
  /** @type {Record<string, number>} */
  const frames = { ArrowLeft: now.frame - step, ArrowRight: now.frame + step, Home: 0, End: nFrames() - 1 };
  /** @type {Record<string, number>} */
  const episodes = { ArrowUp: -1, ArrowDown: 1 };
  if (event.key in frames) pickFrame(frames[event.key]);
  else if (event.key in episodes) pickEpisode(neighbour(episodes[event.key]));
  else if (event.key in ZOOMS) {
    zoomBy(ZOOMS[event.key]);
    pickFrame(now.frame);
  } else if (event.key === " " && target.tagName !== "BUTTON") toggle();
  else return;
  event.preventDefault();
}

/**
 * @param {Element} ribbon
 * @param {MouseEvent} event
 */
function pickInRibbon(ribbon, event) {
  const box = ribbon.getBoundingClientRect();
  const at = ((event.clientX - box.left) / box.width) * page.total;
  const episode = episodeAt(at);
  if (episode >= 0) pickEpisode(episode);
}

/** @param {number} episode */
function pickEpisode(episode) {
  stop();
  chooseEpisode(episode);
}

/** @param {number} frame */
function pickFrame(frame) {
  stop();
  chooseFrame(frame);
}

byId("transport").hidden = false;
byId("switch").hidden = page.readings.length === 1;
for (const [i, radio] of readingRadios.entries()) {
  radio.addEventListener("change", () => switchReading(page.readings[i]));
}
// Whoever chose with the mouse means the frames by the next arrow key. A focused radio button would choose again.
byId("switch").addEventListener("click", (event) => {
  if (!(/** @type {PointerEvent} */ (event).pointerType)) return;
  setTimeout(() => /** @type {HTMLElement} */ (document.activeElement).blur());
});
byId("episode").addEventListener("change", () => pickEpisode(Number(byId("episode").value)));
byId("previous").addEventListener("click", () => pickEpisode(neighbour(-1)));
byId("next").addEventListener("click", () => pickEpisode(neighbour(1)));
byId("frame").addEventListener("input", () => pickFrame(byId("frame").valueAsNumber));
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
for (const ribbon of all(".ribbon")) ribbon.addEventListener("click", (event) => pickInRibbon(ribbon, event));
document.addEventListener("click", follow);
document.addEventListener("keydown", onKey);
// Of two addresses at once the asked one holds: by now, the one that was waiting to be written may stand in its place.
window.addEventListener("hashchange", ({ newURL }) => go(new URL(newURL).hash));

byId("scale").hidden = false;
makeCharts();
chooseReading(right);
if (!go(location.hash)) chooseEpisode(0);

// In a notebook, the frame becomes as high as what it shows: the script beside it listens, and may set it only there.
if (window !== parent) {
  const { documentElement } = document;
  const tell = () => parent.postMessage({ z2rHeight: Math.ceil(documentElement.getBoundingClientRect().height) }, "*");
  new ResizeObserver(tell).observe(documentElement);
}
