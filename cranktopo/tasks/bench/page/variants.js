// History and kept variants.
import { $, make, plain, shown, signed } from "./base.js";
import { FAILS_BELOW, GAUGES, boundOf, state, valueAt } from "./state.js";
import { edit, say } from "./talk.js";

export function showHistory() {
  const { steps, at, diff, commands } = state.project;
  $("history").querySelector("ol").replaceChildren(...steps.map((step, i) => make("li", { class: i === at ? "here" : i > at ? "undone" : "", "aria-current": i === at ? "step" : undefined }, make("button", { type: "button", title: "Go to this step", disabled: i === at, onclick: () => say({ do: "go", to: i }) }, step.what))));
  const list = $("history").querySelector("ol"), here = list.querySelector("li.here");
  if (here) list.scrollTop = here.offsetTop - list.offsetTop - list.clientHeight / 2;
  $("diff").textContent = diff.length ? diff.join("\n") : "No change.";
  const lines = [...commands, ...state.jobs.map((job) => job.command), ...state.project.made.map((file) => file.command)];
  $("commands").textContent = lines.join("\n");
}

const COLUMNS = ["mass", "torsion_per_mass", "bending_per_mass", "fatigue_safety", "unbalance"], SOMETIMES = ["m53_pin", "m53_pin_elements", "m53_journal", "m53_journal_elements"];
export function showVariants() {
  const variants = state.project.variants, table = $("variants").querySelector("table"), checked = variants.some((one) => one.gauges.m53_pin_elements);
  const gauges = [...COLUMNS, ...(checked ? SOMETIMES : [])].map((name) => GAUGES.find((g) => g[0] === name));
  if (!variants.length) {
    for (const id of ["scatter", "parallels"]) $(id).toggleAttribute("hidden", true);
    $("compared").textContent = "";
    $("differing").replaceChildren();
    return table.replaceChildren(make("tbody", {}, make("tr", {}, make("th", {}, "Keep variant puts the design here."))));
  }
  const head = make("tr", {}, make("th", { scope: "col" }, "Variant"), ...gauges.map(([, label, unit]) => make("th", { scope: "col" }, `${label.replace("stiffness ", "").replace(", least", "")} ${unit}`)), make("th", {}, ""));
  const first = variants.find((one) => one.pinned), base = first?.gauges;
  const small = smallPictures(variants);
  const rows = variants.map((variant) => make("tr", { "data-variant": variant.id },
    make("th", { scope: "row", title: variant.what }, small(variant), make("label", {}, make("input", { type: "checkbox", checked: variant.pinned, "aria-label": `compare ${variant.name}`, onchange: (event) => say({ do: "compare", id: variant.id, pinned: event.target.checked }) }), ` ${variant.name}`), make("br"), make("small", {}, variant.what)),
    ...gauges.map(([name, , , digits, , size = 1]) => {
      const value = variant.gauges[name], before = base?.[name];
      return make("td", { class: name === "fatigue_safety" && value < FAILS_BELOW ? "missed" : "" }, value === undefined ? "" : plain(value / size, digits), before && value !== undefined && variant !== first ? ` (${signed(100 * (value / before - 1))})` : "");
    }),
    make("td", {}, make("button", { type: "button", onclick: () => say({ do: "take", id: variant.id }) }, "Take"), make("button", { type: "button", "aria-label": `drop ${variant.name}`, onclick: () => say({ do: "drop", id: variant.id }) }, "Drop"))));
  table.replaceChildren(make("thead", {}, head), make("tbody", {}, ...rows));
  $("compared").textContent = state.project.compared.words;
  $("differing").replaceChildren(...Object.entries(state.project.compared.values).flatMap(takers));
  scatter(variants);
  parallels(variants);
}

// Buttons that take a value in which two variants differ into the design in hand.
function takers([key, values]) {
  const own = JSON.stringify(valueAt(key) ?? null), name = (value) => `${key} ${value === null ? "none" : shown(value)}`;
  return values.filter((value) => JSON.stringify(value) !== own).map((value) => make("button", { type: "button", title: "Take this value alone", onclick: () => edit({ [key]: value }, name(value)) }, `Take ${name(value)}`));
}

// Webs from the front, all to one scale.
function smallPictures(variants) {
  const all = variants.flatMap((one) => one.outlines.flat()), [xs, ys] = [0, 1].map((i) => all.map((point) => point[i]));
  const box = all.length && [Math.min(...xs), -Math.max(...ys), Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys)];
  const path = (points) => make("path", { d: `M${points.map(([x, y]) => `${x},${-y}`).join("L")}Z` });
  return ({ name, outlines }) => (outlines.length ? make("svg", { class: "small", viewBox: box.join(" "), role: "img", "aria-label": `Web of ${name}` }, ...outlines.map(path)) : "");
}

// Variants as lines across one axis for each gauge that all of them know; what is better is up, as far as it has a way.
function parallels(variants) {
  const known = GAUGES.filter(([name, , , , way]) => way && variants.every((one) => one.gauges[name] !== undefined) && new Set(variants.map((one) => one.gauges[name])).size > 1);
  const svg = $("parallels"), step = 380 / Math.max(known.length - 1, 1), shown = variants.length > 1 && known.length > 1;
  svg.toggleAttribute("hidden", !shown);
  if (!shown) return;
  svg.setAttribute("viewBox", "0 0 520 210");
  const x = (i) => 60 + i * step, y = ([name, , , , way], value) => {
    const all = variants.map((one) => one.gauges[name]), share = (value - Math.min(...all)) / (Math.max(...all) - Math.min(...all));
    return 130 - 100 * (way > 0 ? share : 1 - share);
  };
  const axis = (gauge, i) => {
    const [name, label, , digits, way, size = 1] = gauge, all = variants.map((one) => one.gauges[name] / size), ends = [Math.max(...all), Math.min(...all)].map((v) => plain(v, digits));
    const [top, foot] = way > 0 ? ends : ends.reverse();
    return [make("line", { x1: x(i), x2: x(i), y1: 30, y2: 130 }), make("text", { x: x(i), y: 22, "text-anchor": "middle" }, top), make("text", { x: x(i), y: 143, "text-anchor": "middle" }, foot),
      make("text", { x: x(i), y: 156, transform: `rotate(20 ${x(i)} 156)` }, label.replace(" about the crank axis", "").replace(", least", ""))];
  };
  const line = (one, i) => make("path", { class: `of-${i % 5}`, "data-variant-line": one.id, d: `M${known.map((gauge, k) => `${x(k)},${y(gauge, one.gauges[gauge[0]])}`).join("L")}` }, make("title", {}, one.name));
  const name = (one, i) => make("text", { class: `of-${i % 5}`, x: x(known.length - 1) + 8, y: 34 + 12 * i }, one.name);
  svg.replaceChildren(...known.flatMap(axis), ...variants.map(line), ...variants.slice(0, 9).map(name));
}

function scatter(variants) {
  const found = variants.filter((one) => one.gauges.mass && one.gauges.torsion), svg = $("scatter"), bound = { mass: boundOf("mass"), torsion: boundOf("torsion") };
  svg.toggleAttribute("hidden", found.length < 2);
  if (found.length < 2) return;
  const known = (value) => (value === undefined ? [] : [value]);
  const xs = [...found.map((one) => one.gauges.mass), ...known(bound.mass)], ys = [...found.map((one) => one.gauges.torsion), ...known(bound.torsion)].map((y) => y / 1e3);
  const place = (v, all, from, to) => from + ((v - Math.min(...all)) / (Math.max(...all) - Math.min(...all) || 1)) * (to - from);
  svg.setAttribute("viewBox", "0 0 400 190");
  svg.replaceChildren(make("line", { x1: 50, y1: 160, x2: 390, y2: 160 }), make("line", { x1: 50, y1: 10, x2: 50, y2: 160 }),
    ...boundLines(bound, (x) => place(x, xs, 70, 330), (y) => place(y / 1e3, ys, 145, 30)), make("text", { x: 220, y: 182 }, `mass ${plain(Math.min(...xs), 4)} to ${plain(Math.max(...xs), 4)} kg`), make("text", { x: 55, y: 12 }, `torsion ${plain(Math.min(...ys), 4)} to ${plain(Math.max(...ys), 4)} kN m/rad`),
    ...found.flatMap((one, i) => {
      const [x, y] = [place(xs[i], xs, 70, 330), place(ys[i], ys, 145, 30)];
      return [make("circle", { cx: x, cy: y, r: 5 }), make("text", { x: x + 8, y: y + 4 }, one.name)];
    }));
}

// What no web of the design space can beat, by the proof of a job, as lines across the picture.
function boundLines({ mass, torsion }, across, up) {
  const line = (place, words, at) => [make("line", { class: "bound", ...place }), make("text", { class: "bound", ...at }, `${words} (proof)`)];
  return [...(mass === undefined ? [] : line({ x1: across(mass), x2: across(mass), y1: 10, y2: 160 }, "least mass", { x: across(mass) + 4, y: 156 })),
    ...(torsion === undefined ? [] : line({ x1: 50, x2: 390, y1: up(torsion), y2: up(torsion) }, "most torsion", { x: 300, y: up(torsion) - 3 }))];
}
