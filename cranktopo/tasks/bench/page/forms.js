// Forms of the design, made of the schema.
import { $, make, numberOf, shown, words } from "./base.js";
import { lockOf, lockShape, lockTitle, toggleLock } from "./lock.js";
import { state, valueAt } from "./state.js";
import { complain, drag, edit, say, status } from "./talk.js";

const GROUPS = [
  ["Engine", ["engine"]], ["Throw and journals", ["throw"]], ["Web", ["web"]], ["Material", ["material"]],
  ["Goal and limits", ["goal"]], ["Design space", ["envelope"]], ["Supports", ["supports"]], ["Shaft line", ["shaft"]],
  ["Connecting rod", ["rod"]], ["Bolted joints", ["bolted_joint"]], ["Balancer shaft", ["balancer"]],
  ["Bearings", ["bearings"]], ["Crank and ends", ["crank"]], ["Second web", ["second_web"]], ["Forging", ["forging"]], ["Drawing", ["drawing"]],
  ["Fatigue", ["fatigue"]], ["Original", ["original"]], ["Search", ["shape", "optimise"]], ["Effects", ["effects"]],
];

export function showForms() {
  if (!state.reference) return;
  const held = document.activeElement?.dataset?.key, open = openTables(), scroll = $("tree").scrollTop;
  const groups = GROUPS.map(([title, roots]) => {
    const body = roots.flatMap((root) => tableForms(root, root));
    return make("details", { "data-path": `group:${title}`, open: open.has(`group:${title}`) || (!open.size && title === "Web") }, make("summary", {}, title), ...body);
  });
  $("tree").replaceChildren(...groups);
  filterForms();
  showBroken();
  $("tree").scrollTop = scroll;
  if (held) document.querySelector(`[data-key="${CSS.escape(held)}"]:not([type=range])`)?.focus({ preventScroll: true });
}
// The group of forms that the root table of a key is in.
export function groupOf(key) {
  const root = key.split(/[.[]/)[0], found = GROUPS.find(([, roots]) => roots.includes(root));
  return found && document.querySelector(`#tree details[data-path="group:${found[0]}"]`);
}

const openTables = () => new Set([...document.querySelectorAll("#tree details[open]")].map((d) => d.dataset.path));

// Forms of one table of the schema at a place of the design, and of the tables in it.
function tableForms(path, place) {
  const tables = state.reference.filter((table) => table.path === path);
  if (!tables.length) return [];
  const common = tables[0], value = valueAt(place);
  if (common.repeated) {
    const entries = Array.isArray(value) ? value : [];
    return [
      ...entries.flatMap((_, i) => oneTable(tables, path, `${place}[${i}]`, `${words(path.split(".").pop())} ${i + 1}`, true)),
      make("div", { class: "tools" }, ...adders(tables, `${place}[${entries.length}]`, path)),
    ];
  }
  if (value === undefined && !common.required && !common.empty) return [make("div", { class: "tools" }, ...adders(tables, place, path))];
  const title = words(path.split(".").pop()), removable = !common.required && !common.empty;
  if (path.includes(".")) return oneTable(tables, path, place, title, removable);
  return [...tableBody(tables, path, place), ...(removable ? [remover(place, title)] : [])];
}

const remover = (place, title) => make("div", { class: "tools" }, make("button", { type: "button", onclick: () => edit({ [place]: null }, `removed ${title}`) }, `Remove ${title}`));

function oneTable(tables, path, place, title, removable) {
  const body = tableBody(tables, path, place);
  if (removable) body.push(remover(place, title));
  return [make("details", { "data-path": place, open: openTables().has(place) || path === "throw.main_journal" || path === "throw.crankpin" || removable }, make("summary", {}, title), ...body)];
}

function tableBody(tables, path, place) {
  const [common, ...choices] = tables, rows = [];
  const chosen = choices.find((table) => choiceOf(table) === valueAt(`${place}.${table.choice}`));
  if (choices.length) rows.push(choiceRow(choices, place));
  if (chosen) rows.push(...chosen.keys.filter((key) => key.name !== chosen.choice).map((key) => keyRow(key, place)));
  rows.push(...common.keys.filter((key) => key.name !== "mirrored_web").map((key) => keyRow(key, place)));
  const inner = [...new Set(state.reference.map((table) => table.path))].filter((p) => p.startsWith(`${path}.`) && !p.slice(path.length + 1).includes("."));
  if (path === "web" && valueAt("engine.masses")) rows.push(balanceRow());
  if (path === "throw") rows.push(pitchRow());
  return [...rows, ...inner.flatMap((p) => tableForms(p, `${place}.${p.split(".").pop()}`))];
}
// What stays where webs or pins get longer.
function pitchRow() {
  const id = "f-pitch", select = make("select", { id, onchange: () => (state.keepPitch = select.value === "pitch") },
    make("option", { value: "journals", selected: !state.keepPitch }, "main journals"), make("option", { value: "pitch", selected: state.keepPitch }, "pitch of the throws"));
  return make("div", { class: "row", "data-row": "pitch", "data-words": "pitch journals stay keep thickness length" }, make("label", { for: id, title: "Where webs or pins get longer" }, "what stays"), select, make("p", { class: "broken", hidden: true }));
}

// A counterweight for a wanted balance factor.
function balanceRow() {
  const id = "f-balance", input = make("input", { id, inputmode: "decimal", autocomplete: "off", placeholder: "such as 50", onchange: () => {
    const percent = numberOf(input.value);
    if (percent === null) return complain(`Balance factor: '${input.value}' is no number.`);
    say({ do: "balance", percent });
    status("looking for the counterweight");
  } });
  return make("div", { class: "row", "data-row": "balance", "data-words": "balance factor counterweight" }, make("label", { for: id, title: "Share of the oscillating mass; gives the counterweight's radius" }, "wanted balance factor"), input, make("span", { class: "unit" }, "%"), make("p", { class: "broken", hidden: true }));
}

const choiceOf = (table) => table.keys.find((key) => key.name === table.choice).example;

// What a new table begins with: required keys and those that are usually given, with their examples.
function beginning(tables, choice) {
  const keys = [...(choice ? choice.keys : []), ...tables[0].keys].filter((key) => key.required || key.shown);
  return Object.fromEntries(keys.map((key) => [key.name, key.example]));
}

function adders(tables, place, path) {
  const [, ...choices] = tables, title = words(path.split(".").pop());
  const inner = (found) => {
    for (const table of state.reference.filter((t) => t.required === false && t.path.startsWith(`${path}.`) && ["from", "to"].includes(t.path.slice(path.length + 1))))
      found[table.path.split(".").pop()] ??= beginning([table]);
    return found;
  };
  const take = (choice, label) => (path === "rod" ? say({ do: "rod" }) : edit({ [place]: inner(beginning(tables, choice)) }, `added ${label}`)); // a rod has the size of its engine
  const button = (choice, label) => make("button", { type: "button", onclick: () => take(choice, label) }, `Add ${label}`);
  return choices.length ? choices.map((choice) => button(choice, `${title}: ${choiceOf(choice)}`)) : [button(null, title)];
}

function choiceRow(choices, place) {
  const key = choices[0].choice, chosen = valueAt(`${place}.${key}`), id = `f-${place}.${key}`;
  const select = make("select", { id, "data-key": `${place}.${key}`, onchange: () => {
    const old = choices.find((table) => choiceOf(table) === chosen), now = choices.find((table) => choiceOf(table) === select.value);
    const changes = { [`${place}.${key}`]: select.value };
    for (const one of old?.keys ?? []) if (one.name !== key && !now.keys.some((other) => other.name === one.name)) changes[`${place}.${one.name}`] = null;
    for (const one of now.keys) if (one.required && one.name !== key && valueAt(`${place}.${one.name}`) === undefined) changes[`${place}.${one.name}`] = one.example;
    edit(changes, `${words(key)}: ${select.value}`);
  } }, ...choices.map((table) => make("option", { selected: choiceOf(table) === chosen }, choiceOf(table))));
  return make("div", { class: "row" }, make("label", { for: id }, words(key)), select);
}

function keyRow(key, place) {
  const path = `${place}.${key.name}`, value = valueAt(path), id = `f-${path}`, help = `${id}-help`;
  const facts = [key.meaning, key.allowed && `Range: ${key.allowed} ${key.unit}`.trim(), key.default !== null && `Default: ${shown(key.default)}`].filter(Boolean).join(" ");
  const row = make("div", { "data-row": path, "data-words": `${path} ${key.meaning}`.toLowerCase(), class: !ofTexts(key) ? "row" : Array.isArray(value) ? "row texts range" : "row texts" }, make("label", { for: id, title: facts }, words(key.name)));
  const options = key.kind.startsWith("one of ") ? JSON.parse(`[${key.kind.slice(7)}]`) : key.kind === "true or false" ? [true, false] : null;
  if (options) row.append(selectOf(path, id, help, key, options, value));
  else row.append(inputOf(path, id, help, key, value), ...(ofTexts(key) ? [] : [make("span", { class: "unit" }, key.unit, ...lockButton(path, value))]));
  if (!options && typeof value === "number" && ["mm", "deg"].includes(key.unit)) row.append(sliderOf(path, key, value));
  row.append(make("p", { class: "help", id: help }, facts), make("p", { class: "broken", role: "alert", hidden: true }));
  return row;
}

// The lock of a dimension; drawings of the page have the same.
function lockButton(path, value) {
  const lock = value === undefined ? undefined : lockOf(path), name = words(path.split(".").pop());
  if (!lock) return [];
  return [make("button", { type: "button", class: "lock", title: lockTitle(lock), "aria-pressed": String(!lock.limits), "aria-label": `${name}: keep as it is`, onclick: () => toggleLock(lock, name) },
    make("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, ...lockShape(lock.limits)))];
}

function selectOf(path, id, help, key, options, value) {
  const blank = key.required ? [] : [make("option", { value: "", selected: value === undefined }, key.default === null ? "not given" : `${shown(key.default)} (assumed)`)];
  const select = make("select", { id, "data-key": path, "aria-describedby": help, onchange: () => {
    const taken = select.value === "" ? null : options.find((one) => String(one) === select.value);
    edit({ [path]: taken }, `${words(key.name)}: ${taken ?? "as assumed"}`);
  } }, ...blank, ...options.map((one) => make("option", { value: String(one), selected: one === value }, String(one))));
  return select;
}

// A text that may be two of them, as a limit of a range: written one after the other.
const BETWEEN = "; ", ofTexts = (key) => key.kind.includes("list of two texts");
const written = (value, key) => (value === undefined ? "" : ofTexts(key) && Array.isArray(value) ? value.join(BETWEEN) : shown(value));

function read(text, key) {
  if (!text.trim()) return key.required ? undefined : null;
  if (ofTexts(key)) {
    const texts = text.split(/[;\[\]"']|,(?=\s*[<>\u2264\u2265"'])/).map((one) => one.trim().replace(/(\d),(\d)/g, "$1.$2")).filter((one) => one && one !== ",");
    return texts.length > 1 ? texts : texts[0];
  }
  if (key.kind === "text") return text.trim();
  if (key.kind.startsWith("list") || Array.isArray(key.example)) {
    try {
      return JSON.parse(text.trim().startsWith("[") ? text : `[${text}]`);
    } catch {
      return undefined;
    }
  }
  return numberOf(text) ?? (key.kind === "number" || key.kind === "whole number" ? undefined : text.trim());
}

function inputOf(path, id, help, key, value) {
  const numeric = key.kind === "number" || key.kind === "whole number";
  const assumed = key.default !== null ? `${shown(key.default)} (assumed)` : key.required ? "" : "not given";
  const input = make("input", { id, "data-key": path, "aria-describedby": help, inputmode: numeric ? "decimal" : "text", autocomplete: "off", spellcheck: "false",
    placeholder: assumed, list: /(^|\.)material\.name$/.test(path) ? "materials" : undefined, value: written(value, key),
    oninput: () => {
      const found = numeric ? numberOf(input.value) : null;
      if (found !== null) drag({ [path]: found });
    },
    onchange: () => {
      const found = read(input.value, key);
      if (found === undefined) return mark(path, `'${input.value}' is ${numeric ? "no number" : "not understood"}.`);
      edit({ [path]: found }, `${words(key.name)}: ${found === null ? "as assumed" : `${written(found, key)} ${key.unit}`}`.trim());
    } });
  return input;
}

function sliderOf(path, key, value) {
  const [low, high] = rangeOf(key, value), step = Number((10 ** Math.floor(Math.log10((high - low) / 200 || 0.1))).toPrecision(1));
  const slider = make("input", { type: "range", "data-key": path, min: low, max: high, step, value, "aria-label": words(key.name),
    oninput: () => {
      const number = slider.closest(".row").querySelector("input");
      number.value = slider.value;
      drag({ [path]: Number(slider.value) });
    },
    onchange: () => edit({ [path]: Number(slider.value) }, `${words(key.name)}: ${slider.value} ${key.unit}`, true) });
  return slider;
}

function rangeOf(key, value) {
  const span = Math.max(Math.abs(value) * 0.5, key.unit === "deg" ? 10 : 2);
  const found = key.allowed.match(/^(-?[\d.e+]+) to (-?[\d.e+]+)$/);
  const [least, most] = found ? [Number(found[1]), Number(found[2])] : [key.allowed.startsWith("≥ 0") || value >= 0 ? 0 : -Infinity, Infinity];
  const tidy = (x) => Number(x.toPrecision(4));
  return [tidy(Math.max(least, value - span)), tidy(Math.min(most, value + span))];
}

export function filterForms() {
  const sought = $("find").value.trim().toLowerCase();
  document.querySelectorAll("#tree .row[data-row]").forEach((row) => (row.hidden = Boolean(sought) && !row.dataset.words.includes(sought)));
  if (sought) document.querySelectorAll("#tree details").forEach((d) => (d.open = Boolean(d.querySelector(".row[data-row]:not([hidden])"))));
}

// Opens the form of a dimension; its field is ready to be typed in, if asked for.
export function reveal(key, typing = false) {
  const row = document.querySelector(`#tree [data-row="${CSS.escape(key)}"]`);
  for (let at = row?.parentElement; at && at.id !== "tree"; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  row?.scrollIntoView({ block: "nearest" });
  if (typing) row?.querySelector("input")?.select();
}

export function showBroken() {
  document.querySelectorAll("#tree .row.is-broken").forEach((row) => mark(row.dataset.row, ""));
  const homeless = state.broken.filter(({ key, message }) => !mark(key, message)), told = state.dragging ? homeless : state.broken;
  if (told.length) complain(told.map((one) => one.message).join("\n"));
  else if (!state.broken.length && state.dragging) complain("");
}

export function mark(key, text) {
  const row = document.querySelector(`#tree [data-row="${CSS.escape(key)}"]`);
  if (!row) return false;
  row.classList.toggle("is-broken", Boolean(text));
  const line = row.querySelector(".broken");
  line.hidden = !text;
  line.textContent = text;
  row.querySelector("input")?.setAttribute("aria-invalid", text ? "true" : "false");
  if (text) for (let at = row.parentElement; at && at.id !== "tree"; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  return true;
}
