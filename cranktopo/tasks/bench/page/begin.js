// The first page: six questions, designs to open, files to drop.
import { $, make, numberOf } from "./base.js";
import { complain, say, status } from "./talk.js";

const LAYOUTS = ["single", "in-line", "V", "W", "boxer", "radial"];

// Engines of each use with values that are usual there: a beginning, to be replaced by what is known.
const USES = {
  car: { layout: "in-line", cylinders: 4, bore_mm: 80, stroke_mm: 85, speed_rpm: 5500, peak_pressure_MPa: 8, compression_ratio: 10.5 },
  motorcycle: { layout: "V", cylinders: 2, bore_mm: 95, stroke_mm: 70, speed_rpm: 9000, peak_pressure_MPa: 8.5, compression_ratio: 12 },
  aircraft: { layout: "boxer", cylinders: 4, bore_mm: 110, stroke_mm: 98, speed_rpm: 2700, peak_pressure_MPa: 6, compression_ratio: 8.5 },
  "medium speed": { layout: "in-line", cylinders: 6, bore_mm: 320, stroke_mm: 420, speed_rpm: 750, peak_pressure_MPa: 18, compression_ratio: 14 },
};
const NUMBERS = ["cylinders", "bore_mm", "stroke_mm", "speed_rpm", "peak_pressure_MPa", "compression_ratio"];

function useTile([name, values]) {
  return make("button", { type: "button", "data-use": name, title: "Fills in what is usual there", onclick: () => {
    const fields = $("questions").elements;
    fields.layout.value = values.layout;
    showBank();
    for (const key of NUMBERS) fields[key].value = values[key];
    status(`Usual values of ${name}: replace what is known`);
    fields.bore_mm.focus();
  } }, name);
}

// Only a V has an angle between its banks that is asked for.
function showBank() {
  const { layout, bank_angle_deg: bank } = $("questions").elements;
  bank.parentElement.hidden = layout.value !== "V";
  if (layout.value !== "V") bank.value = "";
}

export function showBegin(message) {
  const open = (name) => make("li", {}, make("button", { type: "button", onclick: () => say({ do: "open", name }) }, name));
  $("own-title").hidden = !message.files.length;
  $("own").replaceChildren(...message.files.map(open));
  $("built-in").replaceChildren(...message.designs.map(open));
}

export function showMaterials(names) {
  $("questions").elements.material.replaceChildren(...names.map((name) => make("option", { selected: name === "42CrMo4" }, name)));
  $("materials").replaceChildren(...names.map((name) => make("option", { value: name })));
}

export function beginForm() {
  const form = $("questions"), usual = { single: 1, "in-line": 4, V: 8, W: 12, boxer: 4, radial: 9 };
  form.querySelector("fieldset").append(
    ...LAYOUTS.map((name) => make("label", {}, make("input", { type: "radio", name: "layout", value: name, checked: name === "single",
      onchange: () => (form.elements.cylinders.value = usual[name]) }), ` ${name}`)),
  );
  form.addEventListener("change", showBank);
  showBank();
  $("uses").append(...Object.entries(USES).map(useTile));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const answers = {};
    for (const [name, text] of new FormData(form)) {
      if (!text.trim()) continue;
      const number = ["layout", "name", "material"].includes(name) ? text.trim() : numberOf(text);
      if (number === null) return complain(`${name}: '${text}' is no number.`);
      answers[name] = number;
    }
    say({ do: "start", answers });
  });
  for (const kind of ["dragover", "drop"])
    document.addEventListener(kind, (event) => {
      event.preventDefault();
      if (kind === "drop" && event.dataTransfer.files[0]) upload(event.dataTransfer.files[0]);
    });
  document.addEventListener("paste", (event) => {
    const file = event.clipboardData.files[0] ?? pastedText(event);
    if (!file) return;
    event.preventDefault();
    upload(file);
  });
  $("file").addEventListener("change", () => $("file").files[0] && upload($("file").files[0]));
}

// Copied text as a file: a STEP file, a design under its own name, or a pressure trace; none in a field.
function pastedText(event) {
  if (event.target.closest?.("input, select, textarea")) return null;
  const text = event.clipboardData.getData("text/plain"), name = text.match(/^name\s*=\s*"([\w-]+)"/m)?.[1] ?? "pasted";
  const ending = text.startsWith("ISO-10303-21") ? ".step" : /^\s*\[\w[\w.]*\]/m.test(text) ? ".toml" : /^[^\n]+[,;]/.test(text) ? ".csv" : "";
  return ending ? new File([text], `${name}${ending}`) : null;
}

async function upload(file) {
  status(`reading ${file.name}`);
  const answer = await fetch(`upload?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
  const found = answer.ok ? await answer.json() : { error: `${file.name}: was refused (${answer.status}).` };
  complain(found.error ?? found.told, !found.error);
  status(found.error ? "Not opened" : "Ready");
}
