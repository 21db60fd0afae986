// The page of the bench: what the server tells, and what each part shows of it.
import { $, make, takeUnits } from "./base.js";
import { beginForm, showBegin, showMaterials } from "./begin.js";
import { filterForms, showBroken, showForms } from "./forms.js";
import { showFront } from "./front.js";
import { showGauges } from "./gauges.js";
import { showPicked } from "./pick.js";
import { showMisfire, showPlots } from "./plots.js";
import { showPolars } from "./polar.js";
import { OF_STIFFNESS, ofDesign, ofStep, pick, state } from "./state.js";
import { answered, complain, connect, line, say, status } from "./talk.js";
import { showHistory, showVariants } from "./variants.js";
import { showGhost, showPicture } from "./view.js";
import { outForms, showJobs } from "./work.js";

function hear(message) {
  const act = {
    reference: () => {
      state.reference = message.tables;
      state.ranges = message.ranges;
      takeUnits(message.units);
      showMaterials(message.materials);
    },
    state: () => hearState(message),
    live: () => hearLive(message),
    picked: () => showPicked(message),
    passed: () => answered(message.seq),
    original: () => hearOriginal(message),
    coarse: () => hearCoarse(message),
    settled: () => hearSettled(message),
    jobs: () => ((state.jobs = message.jobs), showJobs()),
    proof: () => status(`${message.kind} is done`),
    made: () => hearMade(message),
    busy: () => status(message.what),
    error: () => (complain(message.message), answered(line.sent)),
    told: () => complain(message.message, true),
  }[message.type];
  if (act) act();
}

function hearState(message) {
  const before = state.project, project = message.project;
  state.project = project;
  state.jobs = message.jobs || [];
  state.noProof = message.no_proof || "";
  $("begin").hidden = Boolean(project);
  $("bench").hidden = !project;
  document.querySelectorAll("header [data-do]").forEach((b) => (b.disabled = !project));
  if (!project) {
    $("warnings").hidden = true;
    return showBegin(message);
  }
  complain(state.madeWarnings, true);
  state.madeWarnings = "";
  $("name").textContent = project.name;
  document.querySelector("[data-do=undo]").disabled = project.at === 0;
  document.querySelector("[data-do=redo]").disabled = project.at + 1 >= project.steps.length;
  if (!before || before.name !== project.name) {
    Object.assign(state, ofDesign());
    $("write").elements.name.value = project.name;
    $("hint").hidden = localStorage.getItem("cranktopo-hint") === "seen";
  }
  if (!before || before.at !== project.at) state.refit = true;
  const moved = !before || before.name !== project.name || before.at !== project.at || before.steps[before.at].file !== project.steps[project.at].file;
  if (moved) {
    Object.assign(state, ofStep());
    status("Solving");
  }
  if (moved || !$("tree").childElementCount) showForms(); // a slider that is held stays
  showMisfire();
  showHistory();
  showMade();
  showVariants();
  showJobs();
  showGauges();
}

function hearLive(message) {
  if (message.seq) answered(message.seq);
  if (message.seq && !state.dragging) return;
  state.broken = message.broken || [];
  showBroken();
  if (message.broken) {
    if (!message.seq) status("The design breaks a rule");
    return;
  }
  state.live = message.gauges;
  for (const name of ["rings", "marks", "stiffness", "warnings"]) state[name] = message[name];
  state.turns = message.turns_deg;
  state.notes = message.notes;
  state.safety = message.safety;
  state.polars = message.polars;
  state.plots = message.plots;
  state.front = message.front;
  state.picture = message.picture;
  showPicture(message.seq);
  showFront();
  showPolars();
  showPlots();
  showGauges();
}

function hearOriginal(message) {
  if (message.broken) return;
  state.original = { ...state.original, ...message.gauges };
  state.originalStiffness = message.stiffness;
  state.originalPolars = message.polars;
  state.originalPlots = message.plots;
  state.ghostFront = message.front;
  state.ghostPicture = message.picture;
  showGhost();
  showFront();
  showPolars();
  showPlots();
  showGauges();
}

function hearCoarse(message) {
  if (state.dragging ? !message.seq : message.seq && message.seq < line.seq) return;
  state.coarse = message.gauges;
  state.coarseErrors = message.error_percent;
  state.coarseTold = true;
  showGauges();
}

function hearSettled(message) {
  const stiff = Object.fromEntries(Object.entries(message.gauges).filter(([name]) => OF_STIFFNESS.has(name)));
  if (message.which === "original") {
    state.original = { ...state.original, ...pick(message.gauges), ...stiff };
    if (message.stiffness_factors) state.originalStiffness = "settled";
    if (message.plots) state.originalShaftPlots = message.plots;
  } else if (!state.dragging) {
    state.settled = pick(message.gauges);
    state.live = { ...state.live, ...stiff };
    if (message.stiffness_factors) state.stiffness = "settled";
    state.shaftPlots = message.plots ?? (state.project.data.shaft ? state.shaftPlots : []);
    if (message.parts.includes("vibration")) state.loadWarnings = message.load_warnings ?? [];
    state.settledWarnings = message.warnings || [];
    state.errors = message.error_percent || {};
    state.settledParts = message.parts;
    state.place = message.place;
    state.point = message.point_mm;
    state.missing = message.missing;
    Object.assign(state, { coarse: {}, coarseTold: false });
    state.fresh = true;
    state.settledPicture = message.picture || null;
    state.colours = message.colours || [];
    if (!state.broken.length) status(statusOf(message.parts));
    if ($("colours").value) showPicture();
  }
  showGauges();
  showPlots();
}

// Stiffness and safety settle side by side; what has not yet is said to follow.
function statusOf(parts) {
  const left = ["stiffness", "film", "shaft", "safety"].filter((part) => !parts.includes(part));
  return left.length ? `Settling; ${left.join(", ")} to follow` : "Settled";
}

function hearMade(message) {
  status(`${message.name} is written`);
  state.madeWarnings = message.warnings?.length ? `${message.name}:\n${message.warnings.join("\n")}` : "";
}

// Files that the session has written, to be downloaded.
function showMade() {
  const link = ({ name }) => make("li", {}, make("a", { href: `made/${encodeURIComponent(name)}`, download: name }, name));
  $("made").replaceChildren(...state.project.made.map(link));
}

function keep() {
  say({ do: "keep" });
  status("The design is kept as a variant");
}

document.querySelectorAll("header [data-do]").forEach((button) => button.addEventListener("click", () => (button.dataset.do === "keep" ? keep() : say({ do: button.dataset.do }))));
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || !state.project) return;
  const act = { z: () => say({ do: event.shiftKey ? "redo" : "undo" }), y: () => say({ do: "redo" }), k: keep }[event.key.toLowerCase()];
  if (!act) return;
  event.preventDefault();
  act();
});
$("message").querySelector("button").addEventListener("click", () => complain(""));
$("hint").querySelector("button").addEventListener("click", () => {
  localStorage.setItem("cranktopo-hint", "seen");
  $("hint").hidden = true;
});
$("find").addEventListener("input", filterForms);
$("tree").addEventListener("focusin", (event) => ($("help").textContent = event.target.closest(".row")?.querySelector(".help")?.textContent ?? ""));
$("ghost").addEventListener("change", () => (showGhost(), showFront()));
for (const id of ["colours", "crank", "section"]) $(id).addEventListener("change", () => showPicture());
$("section").addEventListener("change", () => ($("section-x").disabled = !$("section").checked));
$("section-x").addEventListener("input", () => showPicture());
new ResizeObserver(() => state.front && ((state.frontDrawn = false), delete $("front").dataset.held, showFront())).observe($("front"));
beginForm();
outForms();
connect(hear);
