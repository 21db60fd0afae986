// What a press on the 3D view hits: its form is opened; a web face takes a new pocket or hole.
import { $, lower, make, words } from "./base.js";
import { filterForms, groupOf, reveal } from "./forms.js";
import { say, status } from "./talk.js";

$("viewer").addEventListener("press", (event) => {
  hide();
  say({ do: "pick", sight: event.detail });
});
document.addEventListener("keydown", (event) => event.key === "Escape" && hide());
const hide = () => ($("picked").hidden = true);

export function showPicked({ key, face, x_mm: x, y_mm: y, side }) {
  if (!key) return hide();
  const name = openForm(key), box = $("picked"), place = { face, x_mm: x, y_mm: y, side };
  const adder = (kind) => make("button", { type: "button", onclick: () => {
    hide();
    say({ do: "place", kind, place });
    status(`looking for room for the ${kind}`);
  } }, `Add ${kind} here`);
  const what = face ? `${face === "pin" ? "Pin" : "Journal"} face, x = ${x.toFixed(1)}, y = ${y.toFixed(1)} mm` : name;
  const close = make("button", { type: "button", "aria-label": "Close", onclick: hide }, "\u00d7");
  box.replaceChildren(make("strong", {}, what), close, ...(face ? [adder("pocket"), adder("hole")] : []));
  box.hidden = false;
}

// Opens and focuses the form of a key, or of the table that it is in; returns what it is called.
function openForm(key) {
  if ($("find").value) {
    $("find").value = "";
    filterForms();
  }
  const at = (path) => document.querySelector(`#tree details[data-path="${CSS.escape(path)}"]`);
  let table = key;
  while (table && !at(table)) table = table.replace(/(^|\.)[^.]*$/, "");
  const group = at(table) ?? groupOf(key);
  for (let one = group; one && one.id !== "tree"; one = one.parentElement) if (one.tagName === "DETAILS") one.open = true;
  const row = document.querySelector(`#tree [data-row="${CSS.escape(key)}"]`), input = row?.querySelector("input, select");
  const typed = input && matchMedia("(pointer: fine)").matches; // elsewhere a keyboard would cover the page
  (typed ? input : group?.querySelector("summary"))?.focus({ preventScroll: true });
  if (row) reveal(key, Boolean(typed));
  else group?.scrollIntoView({ block: "nearest" });
  const title = group?.querySelector("summary").textContent ?? words(key), label = row?.querySelector("label").textContent;
  return `${title[0].toUpperCase()}${title.slice(1)}${label ? `: ${lower(label)}` : ""}`;
}
