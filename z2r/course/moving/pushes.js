import { byId, data, follow, say, set, stage, svg, within } from "./moving.js";

const { fps, bodies, view, traces } = data;
/** @type {[start: number, stop: number, what: string, says: string][]} */
const parts = data.parts;
const [frame, play] = [byId("frame"), byId("play")];
const last = traces[0].values.length - 1;
const [width, top, floor] = [200, 8, 44];
const across = (/** @type {number} */ at) => (width * at) / last;

const path = svg("polyline", { class: "line wrong thin" });
const [xs, ys] = bodies.find((/** @type {any} */ { role }) => role === "robot").track;
const move = stage(bodies, view, path);

const dots = traces.map((/** @type {any} */ { name, unit, limit, values }, /** @type {number} */ i) => {
  const most = Math.max(...values);
  const up = (/** @type {number} */ value) => floor - ((floor - top) * value) / most;
  const points = values.map((/** @type {number} */ value, /** @type {number} */ at) => `${across(at)},${up(value)}`);
  const dot = svg("circle", { class: "dot", r: 3 });
  const pushes = parts.filter(([, , what]) => what.startsWith("Push"));
  byId(`trace-${i}`).append(
    ...pushes.map(([start, stop]) =>
      svg("rect", {
        class: "push",
        x: across(start),
        y: top - 4,
        width: across(stop) - across(start),
        height: floor - top + 4,
      }),
    ),
    svg("rect", { class: "band", y: up(limit), width, height: floor - up(limit) }),
    svg("path", { class: "axis thin", d: `M0 ${top - 4}V${floor}H${width}` }),
    svg("polyline", { class: "line right thin", points: points.join(" ") }),
    svg("text", { x: width, y: top + 2, "text-anchor": "end" }, `${name} [${unit}]`),
    dot,
  );
  follow(byId(`trace-${i}`), byId(`trace-${i}`), (x) => go(Math.round(within(x / width) * last)));
  return (/** @type {number} */ at) => set(dot, { cx: across(at), cy: up(values[at]) });
});

const buttons = parts.map(([start, , what, says]) => {
  const button = document.createElement("button");
  button.type = "button";
  button.append(what);
  button.title = says;
  button.addEventListener("click", () => go(start));
  return button;
});
byId("parts").append(...buttons);

const draw = () => {
  const at = frame.valueAsNumber;
  const now = parts.findIndex(([start, stop]) => start <= at && at < stop);
  const [, , what, says] = parts[now];
  move(at);
  for (const put of dots) put(at);
  set(path, {
    points: xs
      .slice(0, at + 1)
      .map((/** @type {number} */ x, /** @type {number} */ i) => `${x},${ys[i]}`)
      .join(" "),
  });
  for (const [i, button] of buttons.entries()) button.setAttribute("aria-pressed", `${i === now}`);
  byId("what").textContent = what;
  byId("says").textContent = says;
  byId("said").textContent = `${(at / fps).toFixed(1)} s`;
  say(frame, `${(at / fps).toFixed(1)} seconds. ${what}: ${says}`);
};

/** @type {{at: number, since: number} | null} */
let playing = null;
const stop = () => {
  playing = null;
  play.textContent = "Play";
};
const go = (/** @type {number} */ at) => {
  stop();
  frame.value = at;
  draw();
};
const advance = (/** @type {number} */ time) => {
  if (!playing) return;
  frame.value = playing.at + Math.max(0, Math.floor(((time - playing.since) / 1000) * fps));
  draw();
  if (frame.valueAsNumber === last) stop();
  else requestAnimationFrame(advance);
};
play.addEventListener("click", () => {
  if (playing) return stop();
  playing = { at: frame.valueAsNumber === last ? 0 : frame.valueAsNumber, since: performance.now() };
  play.textContent = "Pause";
  requestAnimationFrame(advance);
});
frame.addEventListener("input", () => go(frame.valueAsNumber));
frame.max = last;
go(0);
