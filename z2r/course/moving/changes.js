import { byId, data } from "./moving.js";

/** @type {NodeListOf<HTMLButtonElement>} */
const buttons = document.querySelectorAll("button");
/** @type {NodeListOf<HTMLTableRowElement>} */
const lines = document.querySelectorAll("tr[data-name]");

/** @param {HTMLButtonElement} button */
function choose(button) {
  const [[list, number]] = Object.entries(button.dataset);
  const { name, said } = data[list][Number(number)];
  byId("heading").textContent = list === "kinds" ? `mistakes about ${name}` : name;
  for (const [i, id] of ["first", "second", "third"].entries()) byId(id).textContent = said[i] ?? "";
  for (const each of buttons) each.setAttribute("aria-pressed", `${each === button}`);
  for (const [i, line] of lines.entries()) {
    line.classList.toggle("chosen", name === data.rows[i][list === "kinds" ? "kind" : "name"]);
    for (const [place, cell] of line.querySelectorAll("td").entries()) {
      cell.classList.toggle("chosen", list === "columns" && place === Number(number));
    }
  }
}

for (const button of buttons) button.addEventListener("click", () => choose(button));
const [first] = document.querySelectorAll("[data-rows]");
choose(/** @type {HTMLButtonElement} */ (first));
