import { byId, data, degrees, drawn, follow, place, say, set } from "./moving.js";

const [circle, yaw] = [byId("circle"), byId("yaw")];
const blocks = ["right", "wrong"].map((id) => {
  const block = drawn(data.body);
  if (id === "wrong") block.classList.replace("object", "mistaken");
  byId(id).firstElementChild.append(block);
  return block;
});

const draw = () => {
  const radians = (yaw.valueAsNumber * Math.PI) / 180;
  const [sine, cosine] = [Math.sin(radians), Math.cos(radians)];
  const [right, wrong] = [Math.atan2(sine, cosine), Math.atan2(cosine, sine)];
  set(byId("ray"), { d: `M0 0L${cosine} ${-sine}` });
  set(byId("point"), { cx: cosine, cy: -sine });
  set(byId("legs"), { d: `M0 0H${cosine}V${-sine}` });
  set(byId("swapped-ray"), { d: `M0 0L${sine} ${-cosine}` });
  set(byId("swapped-point"), { cx: sine, cy: -cosine });
  for (const [i, turn] of [right, wrong].entries()) place(blocks[i], 0, 0, turn);
  byId("sine").textContent = signed(sine);
  byId("cosine").textContent = signed(cosine);
  byId("right-yaw").textContent = inDegrees(right);
  byId("wrong-yaw").textContent = inDegrees(wrong);
  byId("said").textContent = `${yaw.value}°`;
  say(yaw, `${yaw.value} degrees, read right as ${inDegrees(right)}, swapped as ${inDegrees(wrong)}`);
};
const signed = (/** @type {number} */ value) => `${value < 0 ? "\u2212" : "+"}${Math.abs(value).toFixed(3)}`;
const inDegrees = (/** @type {number} */ value) => `${Math.round(degrees(value))}°`;

yaw.value = data.degrees;
yaw.addEventListener("input", draw);
follow(circle, circle, (x, y) => {
  yaw.value = Math.round(degrees(Math.atan2(-y, x)));
  draw();
});
draw();
