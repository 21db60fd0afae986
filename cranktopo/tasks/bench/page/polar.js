// Forces over the cycle as polar plots, with those of the original behind them.
import { $, make, plain } from "./base.js";
import { state } from "./state.js";

const HALF = 100;
let told = "";

export function showPolars() {
  const box = $("polars"), shown = state.polars ?? [], text = JSON.stringify([shown, state.originalPolars]);
  if (text === told) return;
  told = text;
  box.parentElement.hidden = !shown.length;
  box.replaceChildren(...shown.map((one, i) => polar(one, state.originalPolars?.[i])));
}

function polar({ name, points }, before) {
  const size = ([x, y]) => Math.hypot(x, y), most = Math.max(...points.map(size)), far = Math.max(most, ...(before?.points ?? []).map(size)) || 1;
  const line = (all, kind) => make("path", { class: kind, d: `M${all.map(([x, y]) => `${(HALF * x) / far},${(-HALF * y) / far}`).join("L")}Z` });
  const label = `${name}: at most ${plain(most, 4)} kN`;
  const rings = [0.5, 1].map((share) => make("circle", { cx: 0, cy: 0, r: HALF * share }));
  const svg = make("svg", { viewBox: "-108 -108 216 216", role: "img", "aria-label": `Force over the cycle, ${label}` }, ...rings, ...(before ? [line(before.points, "ghost")] : []), line(points, "now"));
  return make("figure", {}, svg, make("figcaption", {}, label));
}
