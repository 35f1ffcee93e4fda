import { byId, data, drawn, follow, place, say, set, stage, svg, within } from "./moving.js";

const { first, end, episode, steps, said, bodies, view, pictures } = data;
const [scrub, chart] = [byId("scrub"), byId("chart")];
const [width, top, floor] = [200, 12, 88];
const slot = width / (steps.length + 1);
const most = Math.max(...steps);

// A bar for each step. Between the last frame of one episode and the first of the next, nothing was recorded.
const bars = steps.map((/** @type {number} */ step, /** @type {number} */ i) => {
  const height = ((floor - top) * step) / most;
  const kind = first + i + 1 === end ? "leap" : "dot";
  return svg("rect", { class: kind, x: (i + 1.15) * slot, y: floor - height, width: 0.7 * slot, height });
});
const seamAt = (end - first) * slot;
const cursor = svg("path", { class: "line ink thin" });
const label = (/** @type {number} */ x, /** @type {string} */ anchor, /** @type {number} */ number) =>
  svg("text", { x, y: 98, "text-anchor": anchor }, `episode ${number}`);
const ground = svg("path", { class: "axis thin", d: `M0 ${floor}H${width}M${seamAt} 4V100` });
chart.append(ground, ...bars, label(seamAt - 4, "end", episode), label(seamAt + 4, "start", episode + 1), cursor);

/** @type {((frame: number) => void)[]} */
const movers = [];
if (view) {
  // Where the block was when the episode ended, and how it would have had to go.
  const object = bodies.find((/** @type {any} */ { role }) => role === "object") ?? bodies.at(-1);
  const [xs, ys, yaws] = object.track;
  const [ghost, leap] = [drawn(object), end - first];
  ghost.classList.add("ghost");
  place(ghost, xs[leap - 1], ys[leap - 1], yaws[leap - 1]);
  const way = svg("path", {
    class: "line wrong dashed thin",
    d: `M${xs[leap - 1]} ${ys[leap - 1]}L${xs[leap]} ${ys[leap]}`,
  });
  const gone = svg("g", {}, ghost, way);
  movers.push(stage(bodies, view, gone), (at) => gone.setAttribute("visibility", at === leap ? "visible" : "hidden"));
} else {
  movers.push((at) => {
    byId("camera").src = pictures[at];
  });
}

const draw = () => {
  const at = scrub.valueAsNumber;
  const number = first + at;
  const last = number === end - 1 ? "the last of" : number === end ? "the first of" : "in";
  const which = `${last} episode ${number < end ? episode : episode + 1}`;
  for (const move of movers) move(at);
  const moved = at ? `Since the frame before, ${said[at - 1]}.` : "";
  byId("frame").textContent = `frame ${number}`;
  byId("which").textContent = which;
  byId("moved").textContent = moved || "\u00a0";
  byId("moved").className = number === end ? "small wrong" : "small";
  set(cursor, { d: `M${(at + 0.5) * slot} 4V${floor}` });
  say(scrub, `frame ${number}, ${which}. ${moved}`);
};

scrub.max = steps.length;
scrub.value = end - first - 1;
scrub.addEventListener("input", draw);
follow(chart, chart, (x) => {
  scrub.value = within(Math.floor(x / slot), 0, steps.length);
  draw();
});
draw();
