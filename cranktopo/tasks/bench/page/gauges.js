// Gauges against original and limit.
import { $, lower, make, plain, signed } from "./base.js";
import { GAUGES, SOLVED, limitOf, state, valueOf } from "./state.js";

export function showGauges() {
  if (!state.project) return;
  const worse = [], broken = [];
  const rows = GAUGES.map((gauge) => {
    const [name, label] = gauge, [value, ring] = valueOf(name), original = state.original[name];
    if (value === undefined && original === undefined && !SOLVED.has(name)) return null;
    if (value === undefined && original === undefined && state.missing && name.includes("safety")) return null;
    const percent = value !== undefined && original ? 100 * (value / original - 1) : null, better = gauge[4];
    const way = percent === null || !better || Math.abs(percent) < 0.05 ? 0 : Math.sign(percent) * better * Math.sign(original);
    const limit = limitOf(name), holds = limit && value !== undefined && (limit.sense === ">" ? value >= limit.required * (1 - 1e-4 * Math.sign(limit.required)) : value <= limit.required * (1 + 1e-4 * Math.sign(limit.required)));
    const stale = ring.startsWith("stale") || ring.startsWith("waits");
    if (way < 0 && !stale) worse.push(`${lower(label)} ${signed(percent)}`);
    if (limit && !holds && !stale) broken.push(`${lower(label)} ${limit.text}`);
    return gaugeRow(gauge, value, ring, percent, way, limit, holds, stale);
  }).filter(Boolean);
  $("dials").replaceChildren(...rows);
  const line = broken.length ? `Limit not kept: ${broken.join("; ")}.` : "";
  const same = state.project.at === state.project.original && !state.dragging;
  $("worse").textContent = same ? "This is the original." : !state.fresh && !worse.length && !broken.length ? "Nothing known so far is worse than the original." : [line, worse.length ? `Worse than the original: ${worse.join("; ")}.` : "Nothing is worse than the original."].filter(Boolean).join(" ");
  $("worse").className = same ? "" : worse.length || broken.length ? "bad" : "good";
  $("place").textContent = state.place && !state.dragging ? `Least safety: ${state.place}.` : state.missing || "";
  $("notes").replaceChildren(...(state.notes ?? []).map((text) => make("li", {}, text)));
}

function gaugeRow(gauge, value, ring, percent, way, limit, holds, stale) {
  const [name, label, unit, digits, , size = 1] = gauge, original = state.original[name], bound = state.bound[name];
  const text = value === undefined ? "…" : `${plain(value / size, digits)} ${unit}`;
  const change = percent === null ? "" : Math.abs(percent) < 0.05 ? "as original" : signed(percent);
  const item = make("li", { class: stale ? "stale" : "", "data-gauge": name, role: "group", "aria-label": `${label}: ${text}, ${change || "no original yet"}, ${ring}${limit ? `, limit ${limit.text} ${holds ? "holds" : "is not kept"}` : ""}` },
    make("span", {}, label), make("span", { class: "value" }, text), make("span", { class: `change ${way > 0 ? "better" : way < 0 ? "worse" : ""}` }, change));
  if (percent !== null && !["unbalance", "balance_factor"].includes(name)) item.append(trackOf(percent, limit, original, bound));
  const line = make("div", { class: "ring" }, make("span", {}, ring));
  if (limit) line.append(make("span", { class: `limit ${holds ? "holds" : ""}` }, `limit ${limit.text}${holds ? "" : ": not kept"}`));
  if (bound !== undefined) line.append(make("span", {}, `no web beats ${plain(bound / size, digits)} ${unit} (proof)`));
  item.append(line);
  return item;
}

// A bar from 70 to 130 % of the original; black: original, red: limit.
function trackOf(percent, limit, original, bound) {
  const at = (p) => `${Math.max(0, Math.min(100, 50 + (p / 30) * 50))}%`, track = make("span", { class: "track", "aria-hidden": "true" });
  const bar = make("i"), mark = make("b");
  bar.style.left = at(Math.min(0, percent));
  bar.style.right = `calc(100% - ${at(Math.max(0, percent))})`;
  mark.style.left = "50%";
  track.append(bar, mark);
  for (const value of [limit?.required, bound])
    if (value !== undefined) {
      const line = make("u");
      line.style.left = at(100 * (value / original - 1));
      track.append(line);
    }
  return track;
}
