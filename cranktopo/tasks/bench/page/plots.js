// Plots that follow: loads over the cycle, free forces by order, the vibrating shaft; the original's behind them.
import { $, make, plain } from "./base.js";
import { state, valueAt } from "./state.js";
import { edit } from "./talk.js";

const WIDE = 320, HIGH = 120, EDGE = 4, LETTER = 11;
let told = "";

// Which cylinders misfire: one box for each, of an engine with more than one.
export function showMisfire() {
  const cylinders = [...(valueAt("engine.firing_order") ?? [])].sort((a, b) => a - b), out = valueAt("engine.misfire") ?? [], field = $("misfire");
  const text = JSON.stringify([cylinders, out]);
  field.hidden = cylinders.length < 2;
  if (field.dataset.shown === text) return;
  field.dataset.shown = text;
  const turned = (number, on) => cylinders.filter((one) => (one === number ? on : out.includes(one)));
  const box = (number) => make("label", {}, make("input", { type: "checkbox", checked: out.includes(number), onchange: (event) => {
    const now = turned(number, event.target.checked);
    edit({ "engine.misfire": now.length ? now : null }, now.length ? `misfire: cylinder ${now.join(", ")}` : "all cylinders fire");
  } }), ` ${number}`);
  field.replaceChildren(make("legend", {}, "Cylinders that misfire"), ...cylinders.map(box));
}

export function showPlots() {
  const shown = [...state.plots, ...state.shaftPlots], before = [...state.originalPlots, ...state.originalShaftPlots];
  const stale = Boolean(state.shaftPlots.length) && (state.dragging || !state.settledParts.includes("vibration")), text = JSON.stringify([shown, before, stale]);
  if (text === told) return;
  told = text;
  $("plots").parentElement.hidden = !shown.length;
  $("plots").replaceChildren(...shown.map((one, i) => figure(one, before.find((other) => other.name === one.name), stale && i >= state.plots.length)));
}

function figure(one, before, stale) {
  const { drawing, words, high = HIGH } = one.bars ? bars(one, before) : lines(one, before), label = `${one.name}, ${one.unit}: ${words.map(([name]) => name).join("; ")}`;
  const svg = make("svg", { viewBox: `0 0 ${WIDE} ${high}`, role: "img", "aria-label": label }, ...drawing);
  const parts = words.flatMap(([name, kind], i) => [i ? "; " : "", make("span", { class: kind }, name)]);
  return make("figure", { class: stale ? "stale" : "", "data-plot": one.name }, make("figcaption", {}, `${one.name}, ${one.unit}${stale ? " (of the last settled web)" : ""}: `, ...parts), svg);
}

const range = (values) => [Math.min(...values), Math.max(...values)];
const scale = ([low, high], from, to) => (value) => from + ((value - low) / (high - low || 1)) * (to - from);

function lines({ across, curves }, before) {
  const all = [...curves, ...(before?.curves ?? [])].flatMap((curve) => curve.points), ends = range(all.map(([x]) => x)), heights = range([0, ...all.map(([, y]) => y)]);
  const x = scale(ends, EDGE, WIDE - EDGE), y = scale(heights, HIGH - LETTER - 2 * EDGE, EDGE);
  const path = (curve, kind) => make("path", { class: kind, d: `M${curve.points.map(([a, b]) => `${x(a).toFixed(1)},${y(b).toFixed(1)}`).join("L")}` });
  const foot = (value, anchor, text) => make("text", { x: x(value), y: HIGH - 2, "text-anchor": anchor }, text);
  const drawing = [make("line", { x1: x(ends[0]), x2: x(ends[1]), y1: y(0), y2: y(0) }), ...(before?.curves ?? []).map((curve) => path(curve, "ghost")), ...curves.map((curve, i) => path(curve, `of-${i % 5}`)),
    foot(ends[0], "start", plain(ends[0], 4)), foot((ends[0] + ends[1]) / 2, "middle", across), foot(ends[1], "end", plain(ends[1], 4))];
  return { drawing, words: curves.map((curve, i) => [wordsOf(curve), `of-${i % 5}`]) };
}

// A line that says its own height by its name needs no range beside it.
function wordsOf({ name, points }) {
  const [low, high] = range(points.map(([, y]) => y));
  return points.length < 3 ? name : `${name} ${plain(low, 4)} to ${plain(high, 4)}`;
}

function bars({ bars: found, unit }, before) {
  const values = [...found, ...(before?.bars ?? [])].map((one) => one.value), left = 10 + 0.55 * LETTER * Math.max(...found.map((one) => one.name.length));
  const high = Math.max(HIGH, 16 * found.length), x = scale([0, Math.max(...values)], 0, WIDE - EDGE - left), step = (high - 2 * EDGE) / found.length;
  const bar = (one, i, kind) => make("rect", { class: kind, x: left, y: EDGE + i * step + 3, width: x(one.value), height: step - 6 });
  const name = (one, i) => make("text", { x: 0, y: EDGE + (i + 0.5) * step + 4 }, one.name);
  const drawing = [...found.map((one, i) => bar(one, i, "now")), ...(before?.bars ?? []).slice(0, found.length).map((one, i) => bar(one, i, "ghost")), ...found.map(name)];
  return { drawing, high, words: found.map((one) => [`${one.name} ${plain(one.value, 3)} ${unit}`, ""]) };
}
