// Gauges against original and limit.
import { $, lower, make, plain, signed } from "./base.js";
import { GAUGES, SAFETIES, SOLVED, comparable, errorOf, limitOf, state, valueAt, valueOf } from "./state.js";
import { edit } from "./talk.js";

export function showGauges() {
  if (!state.project) return;
  const worse = [], broken = [], below = [];
  const warned = [...state.warnings, ...(state.fresh && !state.dragging ? state.settledWarnings : [])];
  showWarnings(warned);
  const rows = GAUGES.map((gauge) => {
    const [name, label] = gauge, [value, ring] = valueOf(name), original = state.original[name];
    if (value === undefined && original === undefined && !SOLVED.has(name)) return null;
    if (value === undefined && original === undefined && state.missing && SAFETIES(name)) return null;
    const percent = value !== undefined && original && comparable(name) ? 100 * (value / original - 1) : null, better = gauge[4];
    const way = percent === null || !better || Math.abs(percent) < (SAFETIES(name) ? errorOf(name) : 0.05) ? 0 : Math.sign(percent) * better * Math.sign(original);
    const limit = limitOf(name), within = errorOf(name) / 100 + 1e-4, least = limit && limit.required * (1 - within * Math.sign(limit.required)), greatest = limit && limit.required * (1 + within * Math.sign(limit.required)), holds = limit && value !== undefined && (limit.sense === ">" ? value >= least : value <= greatest);
    const stale = ring.startsWith("stale") || ring.startsWith("waits");
    if (way < 0 && !stale) worse.push(`${lower(label)} ${signed(percent)}`);
    if (value < state.marks[name] && !stale) below.push(`${lower(label)} ${plain(value, 3)} of ${state.marks[name]}`);
    if (limit && !holds && !stale) broken.push(`${lower(label)} ${limit.text}`);
    return gaugeRow(gauge, value, ring, percent, way, limit, holds, stale);
  }).filter(Boolean);
  $("dials").replaceChildren(...rows);
  const line = [broken.length ? `Limit not kept: ${broken.join("; ")}.` : "", below.length ? `Below what the rule asks for: ${below.join("; ")}.` : ""].filter(Boolean).join(" ");
  const same = state.project.at === state.project.original && !state.dragging;
  $("worse").textContent = same ? ["This is the original.", line].filter(Boolean).join(" ") : !state.fresh && !worse.length && !line ? "Nothing known so far is worse than the original." : [line, worse.length ? `Worse than the original: ${worse.join("; ")}.` : "Nothing is worse than the original."].filter(Boolean).join(" ");
  $("worse").className = line || (!same && worse.length) ? "bad" : same ? "" : "good";
  $("place").textContent = state.place && state.fresh && !state.dragging ? `Least safety: ${state.place}.` : state.missing || "";
  $("notes").replaceChildren(...(state.notes ?? []).map((text) => make("li", {}, text)));
}

function showWarnings(texts) {
  const list = $("warnings"), shown = [...list.children].map((item) => item.textContent), wanted = texts.map((text) => `Warning: ${text}`);
  list.hidden = !texts.length;
  if (shown.join("\n") !== wanted.join("\n")) list.replaceChildren(...wanted.map((text) => make("li", {}, text)));
}

function gaugeRow(gauge, value, ring, percent, way, limit, holds, stale) {
  const [name, label, unit, digits, , size = 1] = gauge, original = state.original[name], bound = boundOf(name), mark = state.marks[name];
  const text = value === undefined ? "…" : `${plain(value / size, digits)} ${unit}`;
  const change = percent === null ? "" : Math.abs(percent) < 0.05 ? "as original" : signed(percent);
  const item = make("li", { class: stale ? "stale" : "", "data-gauge": name, role: "group", "aria-label": `${label}: ${text}, ${change || "no original yet"}, ${ring}${limit ? `, limit ${limit.text} ${holds ? "holds" : "is not kept"}` : ""}` },
    make("span", {}, label), make("span", { class: "value" }, text), make("span", { class: `change ${way > 0 ? "better" : way < 0 ? "worse" : ""}` }, change));
  if (percent !== null && !["unbalance", "balance_factor"].includes(name)) item.append(trackOf(gauge, percent, limit, original, bound));
  const line = make("div", { class: "ring" }, make("span", {}, ring));
  if (limit) line.append(make("span", { class: `limit ${holds ? "holds" : ""}` }, `limit ${limit.text}${holds ? "" : ": not kept"}`));
  if (mark !== undefined) line.append(make("span", { class: `limit ${value >= mark ? "holds" : ""}` }, `rule: at least ${mark}`));
  if (bound !== undefined) line.append(make("span", {}, `no web beats ${plain(bound / size, digits)} ${unit} (proof)`));
  item.append(line);
  return item;
}

// A bound holds for the design that it was found for.
const boundOf = (name) => (state.bound[name]?.step === state.project.steps[state.project.at].file && !state.dragging ? state.bound[name].value : undefined);

// A bar from 70 to 130 % of the original; black: original, red: limit. A limit is set by dragging its mark.
function trackOf(gauge, percent, limit, original, bound) {
  const at = (p) => `${Math.max(0, Math.min(100, 50 + (p / REACH) * 50))}%`, track = make("span", { class: "track" });
  const bar = make("i"), mark = make("b");
  bar.style.left = at(Math.min(0, percent));
  bar.style.right = `calc(100% - ${at(Math.max(0, percent))})`;
  mark.style.left = "50%";
  track.append(bar, mark);
  if (bound !== undefined) {
    const line = make("s");
    line.style.left = at(100 * (bound / original - 1));
    track.append(line);
  }
  if (state.marks[gauge[0]] !== undefined) {
    const rule = make("s", { class: "rule", title: `the rule asks for ${state.marks[gauge[0]]}` });
    rule.style.left = at(100 * (state.marks[gauge[0]] / original - 1));
    track.append(rule);
  }
  if (limitKeys().has(gauge[0])) track.append(limitMark(gauge, limit, limit ? 100 * (limit.required / original - 1) : 0, track, at));
  return track;
}
const REACH = 30;
const limitKeys = () => new Set(state.reference?.find((table) => table.path === "goal.limits")?.keys.map((key) => key.name));

function limitMark([name, label, , , better], limit, percent, track, at) {
  const sense = `${limit?.sense ?? (better < 0 ? "<" : ">")}=`, most = REACH;
  const mark = make("u", { class: limit ? "" : "none", role: "slider", tabindex: "0", "aria-label": `limit of ${lower(label)}`, "aria-valuemin": 100 - most, "aria-valuemax": 100 + most, title: "Drag: limit in % of the original; double click takes it away" });
  let now = percent, held = false;
  const show = (value) => {
    now = Math.round(2 * Math.max(-most, Math.min(most, value))) / 2;
    mark.style.left = at(now);
    mark.setAttribute("aria-valuenow", 100 + now);
    mark.setAttribute("aria-valuetext", `${sense} ${100 + now} %`);
    mark.dataset.text = `${sense} ${100 + now} %`;
  };
  const take = () => {
    const goal = valueAt("goal") ? {} : name === "mass" ? { "goal.maximise": "torsion_per_mass" } : { "goal.minimise": "mass" };
    edit({ ...goal, [`goal.limits.${name}`]: `${sense} ${100 + now} %` }, `limit: ${lower(label)} ${sense} ${100 + now} %`);
  };
  show(percent);
  mark.addEventListener("pointerdown", (event) => {
    mark.setPointerCapture(event.pointerId);
    held = true;
    mark.classList.add("held");
  });
  mark.addEventListener("pointermove", (event) => {
    const { left, width } = track.getBoundingClientRect();
    if (held) show((2 * (event.clientX - left) / width - 1) * REACH);
  });
  mark.addEventListener("pointerup", () => {
    if (held && now !== percent) take();
    held = false;
    mark.classList.remove("held");
  });
  mark.addEventListener("dblclick", () => limit && edit({ [`goal.limits.${name}`]: null }, `no limit: ${lower(label)}`));
  mark.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 0.5, ArrowUp: 0.5, ArrowLeft: -0.5, ArrowDown: -0.5 }[event.key];
    if (step) show(now + step);
    else if (event.key === "Enter") take();
    else if (event.key === "Delete" && limit) edit({ [`goal.limits.${name}`]: null }, `no limit: ${lower(label)}`);
    else return;
    event.preventDefault();
  });
  return mark;
}
