import { byId, data } from "./moving.js";

const { kinds, columns, rows } = data;
/** @typedef {{kind: string, name: string, marks: string[], checks: string[], dormant: boolean, assumption: string, signature: string}} Row */
const buttons = /** @type {HTMLButtonElement[]} */ ([...document.querySelectorAll("button")]);
const lines = /** @type {HTMLTableRowElement[]} */ ([...document.querySelectorAll("tr[data-name]")]);
const names = (/** @type {Row[]} */ some) => some.map(({ name }) => name).join(", ");
const list = (/** @type {string[]} */ some) => some.join(", ") || "nothing";

/** @type {(row: Row) => string[]} */
const ofRow = ({ name, assumption, signature, checks, dormant }) => [
  name,
  `It believes: ${assumption}.`,
  `What gives it away: ${signature}.`,
  checks.length
    ? `Checks of the audit that find it here: ${checks.join(", ")}.`
    : dormant
      ? "It sleeps: in this dataset it changes nothing, so there is nothing to find."
      : "No check of the audit finds it here.",
];
/** @type {(column: number) => string[]} */
const ofColumn = (column) => {
  const marked = rows.filter((/** @type {Row} */ row) => isMarked(row, column));
  if (column === columns.length) {
    const unseen = rows.filter((/** @type {Row} */ { checks, dormant }) => !checks.length && !dormant);
    return ["checks that find it", `Found by none, though it changes something: ${names(unseen) || "no row"}.`, "", ""];
  }
  const fills = `${marked.length} of ${rows.length} change it: ${names(marked)}.`;
  const other = kinds.filter(
    (/** @type {string} */ kind) => !marked.some((/** @type {Row} */ row) => row.kind === kind),
  );
  return [columns[column], fills, other.length ? `No mistake about ${other.join(" or about ")} does.` : "", ""];
};
/** @type {(kind: string) => string[]} */
const ofKind = (kind) => {
  const own = rows.filter((/** @type {Row} */ row) => row.kind === kind);
  const filled = columns.filter((/** @type {string} */ _, /** @type {number} */ i) =>
    own.some((/** @type {Row} */ row) => row.marks[i]),
  );
  const empty = columns.filter((/** @type {string} */ name) => !filled.includes(name));
  return [`mistakes about ${kind}`, `They change: ${list(filled)}.`, `None of them changes: ${list(empty)}.`, ""];
};
const isMarked = (/** @type {Row} */ row, /** @type {number} */ column) => Boolean(row.marks[column]);

/** @param {HTMLButtonElement} button */
const choose = (button) => {
  const { row, column, kind } = button.dataset;
  const said = row
    ? ofRow(rows.find((/** @type {Row} */ { name }) => name === row))
    : column
      ? ofColumn(Number(column))
      : ofKind(kind ?? "");
  for (const [i, id] of ["heading", "first", "second", "third"].entries()) byId(id).textContent = said[i];
  for (const each of buttons) each.setAttribute("aria-pressed", `${each === button}`);
  for (const [i, line] of lines.entries()) {
    line.classList.toggle("chosen", rows[i].name === row || rows[i].kind === kind);
    for (const [place, cell] of [...line.querySelectorAll("td")].entries()) {
      cell.classList.toggle("chosen", place === Number(column ?? -1));
    }
  }
};
for (const button of buttons) button.addEventListener("click", () => choose(button));
choose(/** @type {HTMLButtonElement} */ (document.querySelector("[data-row]")));
