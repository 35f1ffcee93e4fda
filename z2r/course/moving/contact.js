import { byId, data, drawn, follow, place, say, svg, within } from "./moving.js";

const { bodies, boxes, limit, reach, pusher, yaws } = data;
const ranges = [byId("x"), byId("y")];
const now = { x: pusher[0], y: pusher[1], reading: 0 }; // where the pusher is, from the middle of the block [m]

const worlds = ["above", "inside"].map((id) => {
  const shapes = bodies.map(drawn);
  const world = svg("g", { transform: `translate(0.5 0.5) scale(${0.5 / reach} ${-0.5 / reach})` }, ...shapes);
  byId(id).append(svg("rect", { class: "floor thin", width: 1, height: 1 }), world);
  return { world, shapes };
});

/**
 * How far a point is from the nearest side of a box, less than 0 inside of it.
 * @param {number} across
 * @param {number} along
 * @param {number[][]} box its middle and its half sizes
 */
const distance = (across, along, [[x, y], [halfX, halfY]]) => {
  const [beyondX, beyondY] = [Math.abs(across - x) - halfX, Math.abs(along - y) - halfY];
  return Math.hypot(Math.max(beyondX, 0), Math.max(beyondY, 0)) + Math.min(Math.max(beyondX, beyondY), 0);
};

const draw = () => {
  const yaw = yaws[now.reading];
  const [sine, cosine] = [Math.sin(yaw), Math.cos(yaw)];
  // Turned back by the yaw of the block.
  const [across, along] = [cosine * now.x + sine * now.y, -sine * now.x + cosine * now.y];
  const nearest = Math.min(...boxes.map((/** @type {number[][]} */ box) => distance(across, along, box)));
  const overlap = Math.max(bodies[1].radius - nearest, 0);
  const [above, inside] = worlds.map(({ shapes }) => shapes);
  place(above[0], 0, 0, yaw);
  place(above[1], now.x, now.y, 0);
  place(inside[1], across, along, 0);
  for (const shape of [above[1], inside[1]]) shape.classList.toggle("deep", overlap > limit);
  const said = mm(overlap);
  byId("overlap").textContent = said;
  byId("overlap").classList.toggle("wrong", overlap > limit);
  byId("across").textContent = mm(across);
  byId("along").textContent = mm(along);
  byId("verdict").textContent = verdict(overlap);
  for (const [i, axis] of ["x", "y"].entries()) {
    ranges[i].value = 1000 * now[/** @type {"x" | "y"} */ (axis)];
    byId(`said-${axis}`).textContent = `${ranges[i].valueAsNumber.toFixed(1)} mm`;
    say(ranges[i], `${byId(`said-${axis}`).textContent}, overlap ${said}`);
    byId(`read-${i}`).setAttribute("aria-pressed", `${now.reading === i}`);
  }
};
const mm = (/** @type {number} */ metres) => `${(1000 * metres).toFixed(1)} mm`;
const verdict = (/** @type {number} */ overlap) => {
  if (overlap > limit) return "Two solid bodies cannot be there: something is read wrong.";
  return overlap > 0 ? "A contact gives way by so much." : "They do not touch.";
};

/** @param {Partial<typeof now>} change */
const change = (change) => {
  Object.assign(now, change);
  draw();
};
ranges[0].addEventListener("input", () => change({ x: ranges[0].valueAsNumber / 1000 }));
ranges[1].addEventListener("input", () => change({ y: ranges[1].valueAsNumber / 1000 }));
follow(byId("above"), /** @type {SVGGElement} */ (worlds[0].world), (x, y) =>
  change({ x: within(x, -reach, reach), y: within(y, -reach, reach) }),
);
for (const reading of [0, 1]) byId(`read-${reading}`).addEventListener("click", () => change({ reading }));
byId("reset").addEventListener("click", () => change({ x: pusher[0], y: pusher[1], reading: 0 }));
draw();
