// Jobs and files that are written.
import { $, make, words } from "./base.js";
import { state, valueAt } from "./state.js";
import { say, status } from "./talk.js";
import { showHistory } from "./variants.js";

// Jobs: help, what is asked, and the command and options where they are not of the same name.
const JOBS = {
  shape: { goal: true, help: "Best dimensions of this web that can be made, judged on body-fitted elements: minutes. Comes back as a variant." },
  optimise: { goal: true, help: "Topology in the design space, then a parametric web of it: about two minutes. Comes back as a variant.", left: "The fatigue safety is left to the evaluation." },
  bound: { goal: true, help: "What no web of this design space can beat: half a minute. Comes back as a mark on the gauge.", left: "Stress and bearings are not part of the proof." },
  fatigue: { help: "Least safety by local stress analysis, with stress and strength there: half a minute. Comes back as a variant." },
  "UR M53": { kind: "fatigue", options: { method: "m53" }, help: "Both fillets by the rule's polynomials and by elements, and which governs: about a minute. Comes back as a variant." },
  evaluate: { help: "Mass and both stiffnesses on body-fitted elements, each with a bound of its error: seconds. Comes back as a variant." },
  "whole shaft": { kind: "shaft", help: "All throws together: stiffness, first natural frequency, forces on the main bearings: about a minute." },
  "safety of every web": { kind: "shaft", options: { method: "lsa" }, help: "Every fillet and outlet of every web in the shaft on all its bearings over the cycle: minutes." },
  remodel: { run: true, help: "A web that a die or a mill can make, fitted to the body of a run: about a minute. Comes back as a variant." },
  extract: { run: true, help: "The watertight surface of a run as STL: seconds." },
  rod: { help: "Connecting rod of [rod]: stresses over the cycle, buckling, fatigue, pin and bolts: seconds." },
  "lighter rod": { help: "A lighter rod at no less safety: seconds. Comes back as a variant." },
  bolts: { help: "Bolted joints by VDI 2230 and by Shigley: seconds." },
  balancer: { help: "Balancer shaft of [balancer]: bearing loads and life, deflection, fatigue of its notches: seconds." },
  "lighter balancer": { help: "The lightest balancer shaft within the ranges of the design: seconds. Comes back as a variant." },
  sweep: { vary: true, help: "Many values of one dimension, each evaluated; a page of its own." },
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
  const form = $("job").elements, { help, goal, left } = JOBS[form.kind.value];
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

export function showJobs() {
  const list = $("jobs").querySelector("ul");
  list.replaceChildren(...state.jobs.slice().reverse().map((job) => {
    const buttons = make("span", { class: "tools" });
    if (job.state === "running") buttons.append(make("button", { type: "button", onclick: () => say({ do: "stop", id: job.id }) }, "Stop"));
    if (job.resumable) buttons.append(make("button", { type: "button", onclick: () => say({ do: "resume", id: job.id }) }, "Continue"));
    if (job.page) buttons.append(make("a", { href: `job/${job.id}`, target: "_blank", rel: "noreferrer" }, "Report"));
    return make("li", { "data-job": job.state }, make("strong", {}, `${job.kind} ${job.id}${job.automatic ? ", by itself" : ""}: ${job.state}`), ` ${job.state === "running" ? `${job.seconds} s` : ""} `, buttons, ...progressOf(job), ...(job.found.length ? job.found : job.notes.slice(-2)).map((text) => make("p", { class: /^(NOT|TOO|More than permitted)/.test(text) ? "missed" : "" }, text)));
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
    const { goal, vary, run } = JOBS[form.elements.kind.value];
    showHelp();
    for (const name of ["goal", "limit", "web"]) form.elements[name].parentElement.hidden = !goal;
    form.elements.vary.parentElement.hidden = !vary;
    form.elements.run.parentElement.hidden = !run;
  };
  form.elements.kind.addEventListener("change", chosen);
  form.elements.goal.addEventListener("change", showHelp);
  chosen();
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const name = form.elements.kind.value, { kind = name, goal, vary, run, options } = JOBS[name], asked = { ...options };
    const limits = form.elements.limit.value.split(";").map((one) => one.trim()).filter(Boolean);
    if (goal) Object.assign(asked, form.elements.goal.value === OWN_GOAL ? {} : Object.fromEntries([form.elements.goal.value.split("=")]), limits.length ? { limit: limits } : {}, form.elements.web.value ? { web: form.elements.web.value } : {});
    if (vary) asked.vary = form.elements.vary.value.trim();
    say({ do: "job", kind, options: asked, run: run ? form.elements.run.value : "" });
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
