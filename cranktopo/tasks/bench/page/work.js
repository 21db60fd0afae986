// Jobs and files that are written.
import { $, make } from "./base.js";
import { state } from "./state.js";
import { say, status } from "./talk.js";
import { showHistory } from "./variants.js";

const JOBS = {
  shape: "Best dimensions of this web that can be made, judged on body-fitted elements: minutes. Comes back as a variant.",
  optimise: "Topology in the design space, then a parametric web of it: about two minutes. Comes back as a variant.",
  bound: "What no web of this design space can beat: half a minute. Comes back as a mark on the gauge.",
  fatigue: "Safety on the fine mesh of `cranktopo fatigue`: half a minute.",
  sweep: "Many values of one dimension: give it as KEY=A:B:N in the field Limit.",
};

const FILES = {
  toml: "design (TOML)", "step-throw": "STEP, throw", "step-web": "STEP, web", "step-crank": "STEP, crank", stl: "STL",
  "drawing-pdf": "drawing, PDF", "drawing-svg": "drawing, SVG", m53: "UR M53 papers, PDF", vibration: "torsional vibration, page",
  compare: "comparison with the original, page", table: "table against the original, Markdown",
};

export function showJobs() {
  const list = $("jobs").querySelector("ul");
  list.replaceChildren(...state.jobs.slice().reverse().map((job) => {
    const buttons = make("span", { class: "tools" });
    if (job.state === "running") buttons.append(make("button", { type: "button", onclick: () => say({ do: "stop", id: job.id }) }, "Stop"));
    if (job.resumable) buttons.append(make("button", { type: "button", onclick: () => say({ do: "resume", id: job.id }) }, "Continue"));
    if (job.page) buttons.append(make("a", { href: `job/${job.id}`, target: "_blank", rel: "noreferrer" }, "Report"));
    return make("li", { "data-job": job.state }, make("strong", {}, `${job.kind} ${job.id}: ${job.state}`), ` ${job.state === "running" ? `${job.seconds} s` : ""} `, buttons, make("p", {}, job.notes.slice(-2).join(" | ")));
  }));
  if (state.project) showHistory();
}

export function outForms() {
  const form = $("job");
  form.elements.kind.append(...Object.keys(JOBS).map((name) => make("option", {}, name)));
  const help = () => ($("job-help").textContent = JOBS[form.elements.kind.value]);
  form.elements.kind.addEventListener("change", help);
  help();
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const kind = form.elements.kind.value, limit = form.elements.limit.value.trim(), options = {};
    const [sense, quantity] = form.elements.goal.value.split("=");
    if (["shape", "optimise", "bound"].includes(kind)) options[sense] = quantity;
    if (limit && kind === "sweep") options.vary = limit;
    else if (limit && kind !== "fatigue") options.limit = limit.split(";").map((one) => one.trim());
    say({ do: "job", kind, options });
    status(`${kind} starts`);
  });
  const button = ([kind, text]) => make("button", { type: "button", "data-kind": kind, onclick: () => write(kind) }, text);
  $("write").querySelector(".tools").append(...Object.entries(FILES).map(button));
  $("write").addEventListener("submit", (event) => event.preventDefault());
  $("copy").addEventListener("click", () => navigator.clipboard?.writeText($("commands").textContent));
}

function write(kind) {
  const { name, replace } = $("write").elements, plain = name.value.trim().replace(/\.(toml|step|stl|pdf|svg)$/i, "");
  if (kind === "toml") say({ do: "save", name: `${plain}.toml`, replace: replace.checked });
  else say({ do: "write", kind, name: plain, replace: replace.checked });
}
