// Jobs and files that are written.
import { $, make, words } from "./base.js";
import { state, valueAt } from "./state.js";
import { say, status } from "./talk.js";
import { showHistory } from "./variants.js";

// Jobs: help, the fields that are asked, and the command and options where they are not of the same name.
const OF_GOAL = ["goal", "limit", "web"];
const JOBS = {
  shape: { fields: OF_GOAL, help: "Best dimensions of this web that can be made, judged on body-fitted elements: minutes. Comes back as a variant." },
  optimise: { fields: OF_GOAL, help: "Topology in the design space, then a parametric web of it: about two minutes. Comes back as a variant.", left: "The fatigue safety is left to the evaluation." },
  bound: { fields: OF_GOAL, help: "What no web of this design space can beat: half a minute. Comes back as a mark on the gauge.", left: "Stress and bearings are not part of the proof." },
  fatigue: { help: "Least safety by local stress analysis, with stress and strength there: half a minute. Comes back as a variant." },
  "UR M53": { kind: "fatigue", options: { method: "m53" }, help: "Both fillets by the rule's polynomials and by elements, and which governs: about a minute. Comes back as a variant." },
  evaluate: { help: "Mass and both stiffnesses on body-fitted elements, each with a bound of its error: seconds. Comes back as a variant." },
  "whole shaft": { kind: "shaft", help: "All throws together: stiffness, first natural frequency, forces on the main bearings: about a minute." },
  "safety of every web": { kind: "shaft", options: { method: "lsa" }, help: "Every fillet and outlet of every web in the shaft on all its bearings over the cycle: minutes." },
  remodel: { fields: ["run"], help: "A web that a die or a mill can make, fitted to the body of a run: about a minute. Comes back as a variant." },
  extract: { fields: ["run"], help: "The watertight surface of a run as STL: seconds." },
  rod: { help: "Connecting rod of [rod]: stresses over the cycle, buckling, fatigue, pin and bolts: seconds." },
  "lighter rod": { help: "A lighter rod at no less safety: seconds. Comes back as a variant." },
  bolts: { help: "Bolted joints by VDI 2230 and by Shigley: seconds." },
  balancer: { help: "Balancer shaft of [balancer]: bearing loads and life, deflection, fatigue of its notches: seconds." },
  "lighter balancer": { help: "The lightest balancer shaft within the ranges of the design: seconds. Comes back as a variant." },
  iterate: { fields: ["steps", "web"], help: "Takes a little away, makes a web of what is left, evaluates it, and again; then the dimensions of the best web are searched: many minutes. A table of the steps; the best web comes back as a variant." },
  accuracy: { fields: ["budget"], help: "What accuracy costs: evaluation, fillet stress and optimiser from coarse to fine, until the time is used. Comes back as a table; Stop keeps what is solved by then." },
  sweep: { fields: ["vary"], help: "Many values of one dimension, each evaluated; a page of its own." },
};

// Files by what they are; those of a part only where the design has it.
const FILES = {
  Design: { toml: "design (TOML)", python: "the steps, Python script" },
  Solids: { "step-throw": "STEP, throw", "step-web": "STEP, web", "step-crank": "STEP, crank", stl: "STL", "step-rod": "STEP, rod", "step-balancer": "STEP, balancer shaft" },
  Drawings: { "drawing-pdf": "web, PDF", "drawing-svg": "web, SVG", "drawing-crank": "whole crank, PDF", "drawing-rod": "rod, PDF", "drawing-balancer": "balancer shaft, PDF" },
  Papers: { compare: "comparison with the original, page", m53: "UR M53 papers, PDF", vibration: "torsional vibration, page", "vibration-misfire": "the same, cylinder 1 misfires",
    modes: "natural vibrations, page", balance: "balance of the engine, page", film: "oil film, plot" },
  Tables: { table: "against the original, Markdown", latex: "against the original, LaTeX", loads: "loads over the cycle, CSV" },
};
const OF_PART = { "step-rod": "rod", "step-balancer": "balancer", "drawing-rod": "rod", "drawing-balancer": "balancer", film: "bearings", vibration: "shaft", "vibration-misfire": "shaft", loads: "engine", balance: "engine", m53: "engine" };

function showFiles() {
  for (const button of $("write").querySelectorAll("[data-kind]")) button.hidden = button.dataset.kind in OF_PART && valueAt(OF_PART[button.dataset.kind]) === undefined;
}

// The goal of the design is the first choice where it has one: another goal leaves the design's limits out.
const OWN_GOAL = "own";
function showGoals() {
  const select = $("job").elements.goal, shown = [...select.options].some((one) => one.value === OWN_GOAL), own = Boolean(state.project && valueAt("goal"));
  if (own && !shown) {
    select.prepend(make("option", { value: OWN_GOAL }, "that of the design"));
    select.value = OWN_GOAL;
  } else if (!own && shown) select.querySelector(`[value=${OWN_GOAL}]`).remove();
  showHelp();
}

function showHelp() {
  const form = $("job").elements, { help, fields, left } = JOBS[form.kind.value], goal = fields === OF_GOAL;
  $("job-help").textContent = [help, goal && limitWords(form.goal.value), goal && left].filter(Boolean).join(" ");
}

function limitWords(goal) {
  const limits = Object.entries(state.project?.limits ?? {}).map(([name, each]) => `${words(name)} ${each.map((one) => one.text).join(" and ")}`);
  const own = limits.length && goal === OWN_GOAL ? `Keeps the limits of the design: ${limits.join("; ")}; a limit written here replaces that of the same quantity.` : limits.length ? "The limits of the design do not count with another goal than its own." : "";
  return `${own} What no limit names may not get worse than it is, but for the goal's own quantity: mass, both stiffnesses, the unbalance of a counterweight, and the fatigue safety where engine and material make it known.`.trim();
}

// How far a job is, and the time left, as it tells itself; one that does not tell has a bar without an end.
function progressOf({ state: at, pace }) {
  if (at !== "running") return [];
  const bar = make("progress", { max: 1, "aria-label": "Progress" });
  if (pace) bar.value = pace.share;
  return [bar, make("span", { class: "left" }, pace ? `${Math.round(100 * pace.share)} %${pace.left ? `, ${pace.left} left` : ""}` : "")];
}

function tableOf({ kind, id, table: [head, ...rows] }) {
  if (!rows.length) return [];
  const side = head.map((_, i) => (rows.some((row) => /[a-z]/.test(row[i])) ? "words" : undefined));
  const cell = (text, i) => (i ? make("td", { class: side[i] }, text) : make("th", { scope: "row" }, text));
  const heads = make("thead", {}, make("tr", {}, ...head.map((text, i) => make("th", { scope: "col", class: side[i] }, text))));
  const body = make("tbody", {}, ...rows.map((row) => make("tr", {}, ...row.map(cell))));
  return [make("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": `Table of ${kind} ${id}` }, make("table", {}, heads, body))];
}

export function showJobs() {
  const list = $("jobs").querySelector("ul");
  list.replaceChildren(...state.jobs.slice().reverse().map((job) => {
    const buttons = make("span", { class: "tools" });
    if (job.state === "running") buttons.append(make("button", { type: "button", onclick: () => say({ do: "stop", id: job.id }) }, "Stop"));
    if (job.resumable) buttons.append(make("button", { type: "button", onclick: () => say({ do: "resume", id: job.id }) }, "Continue"));
    if (job.page) buttons.append(make("a", { href: `job/${job.id}`, target: "_blank", rel: "noreferrer" }, "Report"));
    return make("li", { "data-job": job.state }, make("strong", {}, `${job.kind} ${job.id}${job.automatic ? ", by itself" : ""}: ${job.state}`), ` ${job.state === "running" ? `${job.seconds} s` : ""} `, buttons, ...progressOf(job), ...(job.found.length ? job.found : job.notes.slice(-2)).map((text) => make("p", { class: /^(NOT|TOO|More than permitted)/.test(text) ? "missed" : "" }, text)), ...tableOf(job));
  }));
  const runs = state.jobs.filter((job) => job.kind === "optimise" && job.state === "done").map((job) => job.id), select = $("job").elements.run;
  if ([...select.options].map((one) => one.value).join() !== runs.join()) select.replaceChildren(...runs.map((id) => make("option", { value: id }, `optimise ${id}`)));
  showGoals();
  if (state.project) {
    showHistory();
    showFiles();
  }
}

export function outForms() {
  const form = $("job");
  form.elements.kind.append(...Object.keys(JOBS).map((name) => make("option", {}, name)));
  const chosen = () => {
    const { fields = [] } = JOBS[form.elements.kind.value];
    showHelp();
    for (const field of form.querySelectorAll("[name]:not([name=kind])")) field.disabled = field.parentElement.hidden = !fields.includes(field.name);
  };
  form.elements.kind.addEventListener("change", chosen);
  form.elements.goal.addEventListener("change", showHelp);
  chosen();
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const name = form.elements.kind.value, { kind = name, options } = JOBS[name];
    const value = (field) => (form.elements[field].disabled ? "" : form.elements[field].value.trim());
    const plain = ["web", "steps", "budget", "vary"].map((field) => [field, value(field)]), goal = value("goal");
    const limit = value("limit").split(";").map((one) => one.trim()).filter(Boolean);
    const asked = { ...options, ...Object.fromEntries([...plain, goal === OWN_GOAL ? [] : goal.split("=")].filter(([, given]) => given)), ...(limit.length ? { limit } : {}) };
    say({ do: "job", kind, options: asked, run: value("run") });
    status(`${name} starts`);
  });
  const button = ([kind, text]) => make("button", { type: "button", "data-kind": kind, onclick: () => write(kind) }, text);
  const group = ([title, files]) => make("div", { class: "tools", role: "group", "aria-label": title }, make("span", {}, title), ...Object.entries(files).map(button));
  $("write").append(...Object.entries(FILES).map(group));
  $("write").addEventListener("submit", (event) => event.preventDefault());
  $("copy").addEventListener("click", () => navigator.clipboard?.writeText($("commands").textContent));
}

function write(kind) {
  const { name, replace } = $("write").elements, plain = name.value.trim().replace(/\.(toml|step|stl|pdf|svg|tex|md)$/i, "");
  if (kind === "toml") say({ do: "save", name: `${plain}.toml`, replace: replace.checked });
  else if (kind === "python") say({ do: "script", name: plain, replace: replace.checked });
  else say({ do: "write", kind, name: plain, replace: replace.checked });
}
