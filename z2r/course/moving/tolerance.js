import { byId, data, follow, say, set, svg } from "./moving.js";

/** @type {{name: string, unit: string, limit: number, step: number, most: number, errors: number[]}[]} */
const sides = data.sides;
const plot = byId("plot");
const [left, right, top, bottom] = [26, 296, 6, 166];
const ranges = [byId("limit-0"), byId("limit-1")];
const ends = sides.map((side) => 1.08 * Math.max(side.most, ...side.errors));
const across = (/** @type {number} */ value) => left + ((right - left) * value) / ends[0];
const up = (/** @type {number} */ value) => bottom - ((bottom - top) * value) / ends[1];
const digits = sides.map(({ step }) => Math.round(-Math.log10(step)));
const said = (/** @type {number} */ i, /** @type {number} */ value) => `${value.toFixed(digits[i])} ${sides[i].unit}`;

const box = svg("path", { class: "band box thin" });
const corner = svg("circle", { class: "corner", r: 5 });
const numbers = [...sides[0].errors.keys()];
const marks = numbers.map(() => svg("path", {}));
const labels = numbers.map((number) => svg("text", {}, `${number}`));
plot.append(
  svg("path", { class: "axis thin", d: `M${left} ${top}V${bottom}H${right}` }),
  svg("text", { x: right, y: bottom + 20, "text-anchor": "end" }, `${sides[0].name} [${sides[0].unit}]`),
  svg("text", { x: left + 4, y: top + 4 }, `${sides[1].name} [${sides[1].unit}]`),
  box,
  ...marks,
  ...labels,
  corner,
);
for (const [i, { limit, most }] of sides.entries()) {
  for (const value of [limit, most]) {
    const at = i ? { x: left - 3, y: up(value) + 2.5, "text-anchor": "end" } : { x: across(value), y: bottom + 9 };
    plot.append(svg("text", { "text-anchor": "middle", ...at }, `${value}`));
  }
}

// A number stands beside its dot, where no other dot or number is in the way.
const places = numbers.map((number) => [across(sides[0].errors[number]), up(sides[1].errors[number])]);
const taken = [...places];
const around = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [9 * Math.cos((i * Math.PI) / 4), 7 * Math.sin((i * Math.PI) / 4)]);
for (const [number, [x, y]] of places.entries()) {
  const spots = around.map(([dx, dy]) => [x + dx, y + dy]).filter(([, dy]) => dy < bottom - 3);
  const room = (/** @type {number[]} */ [a, b]) => Math.min(...taken.map(([c, d]) => Math.hypot(a - c, b - d)));
  const best = spots.reduce((one, other) => (Math.min(room(other), 8) > Math.min(room(one), 8) ? other : one));
  taken.push(best);
  set(labels[number], { x: best[0], y: best[1] + 2.5, "text-anchor": "middle" });
}

const draw = () => {
  const limits = ranges.map((range) => range.valueAsNumber);
  const inside = numbers.map((number) => sides.every(({ errors }, i) => errors[number] < limits[i]));
  const [width, height] = [across(limits[0]), up(limits[1])];
  set(box, { d: `M${left} ${height}H${width}V${bottom}H${left}Z` });
  set(corner, { cx: width, cy: height });
  for (const number of numbers) {
    const [x, y] = places[number];
    const dot = "m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z";
    const cross = "m-3 -3l6 6m0 -6l-6 6";
    set(marks[number], { class: inside[number] ? "dot" : "cross", d: `M${x} ${y}${inside[number] ? dot : cross}` });
  }
  const out = numbers.filter((number) => !inside[number]);
  byId("count").textContent = `${numbers.length - out.length} of ${numbers.length} reached`;
  byId("says").textContent = `within ${limits.map((limit, i) => said(i, limit)).join(" and ")}`;
  byId("out").textContent = out.length ? `Not reached: ${out.join(", ")}` : "None is left out.";
  for (const [i, range] of ranges.entries()) {
    byId(`said-${i}`).textContent = said(i, limits[i]);
    say(range, `${said(i, limits[i])}: ${byId("count").textContent}`);
  }
};

const reset = () => {
  for (const [i, range] of ranges.entries()) range.value = sides[i].limit;
  draw();
};
for (const range of ranges) range.addEventListener("input", draw);
byId("reset").addEventListener("click", reset);
follow(plot, plot, (x, y) => {
  ranges[0].value = (ends[0] * (x - left)) / (right - left);
  ranges[1].value = (ends[1] * (bottom - y)) / (bottom - top);
  draw();
});
reset();
