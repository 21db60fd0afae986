// Gauges against original and limit.
import { $, lower, make, plain, signed, words } from "./base.js";
import { FAILS_BELOW, GAUGES, OF_TABLE, SAFETIES, SOLVED, boundOf, changeOf, comparable, errorOf, inPoints, limitsOf, priceOf, state, valueAt, valueOf } from "./state.js";
import { edit } from "./talk.js";
import { showPlace } from "./view.js";

export function showGauges() {
  if (!state.project) return;
  const worse = [], broken = [], below = [], fails = [];
  const warned = [...state.warnings, ...state.loadWarnings, ...(state.fresh && !state.dragging ? state.settledWarnings : [])];
  showWarnings(warned);
  const rows = GAUGES.map((gauge) => {
    const [name, label] = gauge, [value, ring] = valueOf(name), original = state.original[name];
    if (value === undefined && original === undefined && !SOLVED.has(name) && !ring.startsWith("waits")) return null;
    if (value === undefined && original === undefined && (state.missing && SAFETIES(name) || isLeftOut(OF_TABLE[name]))) return null;
    const percent = value !== undefined && original && comparable(name) ? changeOf(name, value) : null, better = gauge[4];
    const way = percent === null || !better || Math.abs(percent) < (SAFETIES(name) ? errorOf(name) : 0.05) ? 0 : Math.sign(percent) * better * Math.sign(original);
    const limits = limitsOf(name, value), text = shownValue(gauge, value);
    const stale = ring.startsWith("stale") || ring.startsWith("waits");
    if (way < 0 && !stale) worse.push(`${lower(label)} ${signed(percent)}`);
    if (value < state.marks[name] && !stale) below.push(`${lower(label)} ${plain(value, 3)} of ${state.marks[name]}`);
    if (name === "fatigue_safety" && value < FAILS_BELOW && !stale) fails.push(`It fails by fatigue: the safety of ${text} is below ${FAILS_BELOW}.`);
    if (value !== undefined && !stale) for (const limit of limits) if (!limit.holds) broken.push(`${lower(label)} ${limit.text} (it is ${text})`);
    return gaugeRow(gauge, value, text, ring, percent, way, limits, stale);
  }).filter(Boolean);
  keepSame($("dials"), rows);
  const line = [...fails, broken.length ? `Limit not kept: ${broken.join("; ")}.` : "", below.length ? `Below what the rule asks for: ${below.join("; ")}.` : ""].filter(Boolean).join(" ");
  const same = state.project.at === state.project.original && !state.dragging;
  $("worse").textContent = same ? ["This is the original.", line].filter(Boolean).join(" ") : !state.fresh && !worse.length && !line ? "Nothing known so far is worse than the original." : [line, worse.length ? `Worse than the original: ${worse.join("; ")}.` : "Nothing is worse than the original."].filter(Boolean).join(" ");
  $("worse").className = line || (!same && worse.length) ? "bad" : same ? "" : "good";
  showWhere();
  const unproven = state.noProof ? [`No bound is proven: ${state.noProof}`] : [];
  $("notes").replaceChildren(...[...(state.notes ?? []), ...withoutGauge(), ...unproven].map((text) => make("li", {}, text)));
}

// Takes new rows where they say something else: what is not painted anew costs no time while dragging.
function keepSame(list, rows) {
  const before = [...list.children], alike = before.length === rows.length && rows.every((row, i) => row.dataset.gauge === before[i].dataset.gauge);
  if (!alike) return list.replaceChildren(...rows);
  rows.forEach((row, i) => row.isEqualNode(before[i]) || before[i].replaceWith(row));
}

function showWhere() {
  const known = state.place && state.fresh && !state.dragging, text = known ? `Least safety: ${state.place}.` : state.missing || "";
  if ($("place").textContent === text) return; // a press of its button goes on
  $("place").replaceChildren(known ? make("button", { type: "button", title: "Turn the view there", onclick: showPlace }, text) : text);
}

function showWarnings(texts) {
  const list = $("warnings"), shown = [...list.children].map((item) => item.textContent), wanted = texts.map((text) => `Warning: ${text}`);
  list.hidden = !texts.length;
  if (shown.join("\n") !== wanted.join("\n")) list.replaceChildren(...wanted.map((text) => make("li", {}, text)));
}

const isLeftOut = (table) => Boolean(table) && !Object.keys(valueAt(table) ?? {}).length;
const shownValue = ([, , unit, digits, , size = 1], value) => (value === undefined ? "…" : `${plain(value / size, digits)} ${unit}`.trim());

// Limits that no gauge stands for are the jobs' alone.
const withoutGauge = () => Object.entries(state.project.limits).filter(([name]) => !GAUGES.some(([gauge]) => gauge === name))
  .map(([name, limits]) => `No gauge shows the limit of ${words(name)}, ${limits.map((one) => one.text).join(" and ")}: jobs judge it.`);

function gaugeRow(gauge, value, text, ring, percent, way, limits, stale) {
  const [name, label, unit, digits, , size = 1] = gauge, original = state.original[name], bound = boundOf(name), mark = state.marks[name];
  const change = percent === null ? "" : Math.abs(percent) < 0.05 ? "as original" : signed(percent, inPoints(name) ? "points" : "%");
  const told = limits.map((limit) => `limit ${limit.text}${limit.holds || value === undefined ? "" : ": not kept"}`);
  const item = make("li", { class: stale ? "stale" : "", "data-gauge": name, role: "group", "aria-label": `${label}: ${text}, ${change || "no original yet"}, ${[ring, ...told].join(", ")}` },
    make("span", {}, label), make("span", { class: "value" }, text), make("span", { class: `change ${way > 0 ? "better" : way < 0 ? "worse" : ""}` }, change));
  if (percent !== null && name !== "unbalance") item.append(trackOf(gauge, percent, limits, original, bound)); // it passes 0
  const line = make("div", { class: "ring" }, make("span", {}, ring));
  limits.forEach((limit, i) => line.append(make("span", { class: `limit ${limit.holds ? "holds" : ""}` }, told[i])));
  if (name === "fatigue_safety" && value < FAILS_BELOW) line.append(make("span", { class: "limit" }, `below ${FAILS_BELOW}: it fails`));
  if (mark !== undefined) line.append(make("span", { class: `limit ${value >= mark ? "holds" : ""}` }, `rule: at least ${mark}`));
  const price = priceOf(name);
  if (price) line.append(make("span", {}, price));
  if (bound !== undefined) line.append(make("span", {}, `no web beats ${plain(bound / size, digits)} ${unit} (proof)`));
  item.append(line);
  return item;
}

// A bar from 70 to 130 % of the original, or 30 points below and above it; black: original, red: limits. A limit is set by dragging its mark.
function trackOf(gauge, percent, limits, original, bound) {
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
  if (limitKeys().has(gauge[0])) track.append(...(limits.length ? limits : [null]).map((limit) => limitMark(gauge, limit, limits, track, at)));
  return track;
}
const REACH = 30;
const limitKeys = () => new Set(state.reference?.find((table) => table.path === "goal.limits")?.keys.map((key) => key.name));

// The mark of one of the limits of a gauge, or of one to come; the other one of a range stays where it is.
function limitMark([name, label, , , better], limit, limits, track, at) {
  const sense = limit?.sense ?? (better < 0 ? "<=" : ">="), most = REACH, percent = limit ? changeOf(name, limit.required) : 0;
  const middle = inPoints(name) ? Math.round(10 * state.original[name]) / 10 : 100, others = limits.filter((one) => one !== limit).map((one) => one.text);
  const textAt = (place) => `${sense} ${Number((middle + place).toFixed(1))} %`, one = (text) => (others.length ? [text, ...others] : text);
  const mark = make("u", { class: limit ? "" : "none", role: "slider", tabindex: "0", "aria-label": `limit of ${lower(label)}${others.length ? `, ${sense}` : ""}`, "aria-valuemin": middle - most, "aria-valuemax": middle + most, title: `Drag: limit in %${inPoints(name) ? "" : " of the original"}; double click takes it away` });
  let now = percent, held = false;
  const show = (value) => {
    now = Math.round(2 * Math.max(-most, Math.min(most, value))) / 2;
    mark.style.left = at(now);
    mark.setAttribute("aria-valuenow", middle + now);
    mark.setAttribute("aria-valuetext", textAt(now));
    mark.dataset.text = textAt(now);
  };
  const take = () => {
    const goal = valueAt("goal") ? {} : name === "mass" ? { "goal.maximise": "torsion_per_mass" } : { "goal.minimise": "mass" };
    edit({ ...goal, [`goal.limits.${name}`]: one(textAt(now)) }, `limit: ${lower(label)} ${textAt(now)}`);
  };
  const remove = () => limit && edit({ [`goal.limits.${name}`]: others[0] ?? null }, `no limit: ${lower(label)} ${limit.text}`);
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
  mark.addEventListener("dblclick", remove);
  mark.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 0.5, ArrowUp: 0.5, ArrowLeft: -0.5, ArrowDown: -0.5 }[event.key];
    if (step) show(now + step);
    else if (event.key === "Enter") take();
    else if (event.key === "Delete") remove();
    else return;
    event.preventDefault();
  });
  return mark;
}
