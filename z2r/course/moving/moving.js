// What all moving pictures share. Each shows what it is given as data; names are written as text, never as markup.
// These are modules for who checks them. In a page all is one script, without the words import and export.

/** @type {(id: string) => any} */
export const byId = (id) => document.getElementById(id);
export const data = JSON.parse(byId("data").textContent);

/** @param {number} radians */
export const degrees = (radians) => (radians * 180) / Math.PI;

/**
 * @param {string} name
 * @param {Record<string, string | number>} attributes
 * @param {(Node | string)[]} children
 */
export function svg(name, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, `${value}`);
  element.append(...children);
  return element;
}

/**
 * @param {Element} element
 * @param {Record<string, string | number>} attributes
 */
export function set(element, attributes) {
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, `${value}`);
}

/** @param {number[][]} outline */
const loop = (outline) => `M${outline.join("L")}Z`;

/**
 * A body seen from above, in metres: an outline, or else a disc.
 * @param {{role: string, outline: number[][], radius: number}} body
 */
export function drawn({ role, outline, radius }) {
  const look = { class: `${role} thin` };
  return outline.length ? svg("path", { ...look, d: loop(outline) }) : svg("circle", { ...look, r: radius });
}

/**
 * @param {Element} element
 * @param {number} x
 * @param {number} y
 * @param {number} yaw in radians
 */
export const place = (element, x, y, yaw) =>
  set(element, { transform: `translate(${x} ${y}) rotate(${degrees(yaw)})` });

/**
 * Draw bodies in a square picture, with a key; return what moves them to where they are in a frame.
 * @param {{label: string, role: string, outline: number[][], radius: number, track: number[][]}[]} bodies
 * @param {number[]} view the least x and y, and the width
 * @param {Node[]} below what is drawn below them, in metres
 */
export function stage(bodies, [x, y, size], ...below) {
  const shapes = bodies.map(drawn);
  const world = { transform: `scale(${1 / size} ${-1 / size}) translate(${-x} ${-y - size})` };
  byId("scene").append(svg("rect", { class: "floor thin", width: 1, height: 1 }), svg("g", world, ...below, ...shapes));
  for (const { label, role } of bodies) {
    const [item, swatch] = [document.createElement("span"), document.createElement("i")];
    swatch.className = `swatch ${role}`;
    item.append(swatch, label);
    byId("key").append(item);
  }
  return (/** @type {number} */ at) => {
    for (const [i, { track }] of bodies.entries()) place(shapes[i], track[0][at], track[1][at], track[2][at]);
  };
}

/**
 * Let a pointer move what is in a picture.
 * @param {SVGSVGElement} picture
 * @param {SVGGraphicsElement} group in whose unit the place is told
 * @param {(x: number, y: number) => void} move
 */
export function follow(picture, group, move) {
  const tell = (/** @type {PointerEvent} */ event) => {
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(group.getScreenCTM()?.inverse());
    move(x, y);
  };
  picture.addEventListener("pointerdown", (event) => {
    picture.setPointerCapture(event.pointerId);
    tell(event);
  });
  picture.addEventListener("pointermove", (event) => picture.hasPointerCapture(event.pointerId) && tell(event));
}

/**
 * @param {HTMLInputElement} range
 * @param {string} said
 */
export function say(range, said) {
  const [low, high] = [Number(range.min), Number(range.max)];
  range.style.setProperty("--done", `${(100 * (range.valueAsNumber - low)) / (high - low)}%`);
  range.setAttribute("aria-valuetext", said);
}

/** @param {number} value */
export const within = (value, low = 0, high = 1) => Math.min(Math.max(value, low), high);

// The frame becomes as high as what it shows, and the still before it goes: at once, since a browser does not observe
// what is out of sight.
const tell = () => {
  const height = Math.ceil(document.documentElement.getBoundingClientRect().height);
  parent.postMessage({ z2rHeight: height, z2rInPlace: true }, "*");
};
new ResizeObserver(tell).observe(document.documentElement);
addEventListener("load", tell);
