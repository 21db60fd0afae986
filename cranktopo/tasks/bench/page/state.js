// What the page knows: gauges, the design, its answers; and what is read off them.

// Gauges: name, label, unit, digits, which way is better (0: neither), size of the unit.
export const GAUGES = [
  ["mass", "Mass", "kg", 4, -1], ["torsion_per_mass", "Torsional stiffness per mass", "kN m/rad/kg", 4, 1, 1e3],
  ["bending_per_mass", "Bending stiffness per mass", "kN/mm/kg", 4, 1, 1e3],
  ["fatigue_safety", "Fatigue safety, least", "", 3, 1], ["pin_fillet_safety", "Safety, pin fillet", "", 3, 1],
  ["journal_fillet_safety", "Safety, journal fillet", "", 3, 1], ["outlet_safety", "Safety, oil outlets", "", 3, 1], ["stress", "Largest von Mises stress", "MPa", 4, -1],
  ["torsion", "Torsional stiffness", "kN m/rad", 4, 1, 1e3], ["bending", "Bending stiffness", "kN/mm", 4, 1, 1e3],
  ["inertia", "Inertia about the crank axis", "kg mm2", 5, -1], ["unbalance", "Unbalance", "kg mm", 4, 0],
  ["balance_factor", "Balance factor of the oscillating mass", "%", 3, 0],
  ["m53_pin", "UR M53 polynomials, pin fillet", "", 3, 1], ["m53_journal", "UR M53 polynomials, journal fillet", "", 3, 1],
  ["m53_pin_elements", "UR M53 elements, pin fillet", "", 3, 1], ["m53_journal_elements", "UR M53 elements, journal fillet", "", 3, 1],
  ["natural_frequency", "First natural frequency", "Hz", 4, 0], ["piston_gap", "Gap to the piston skirt", "mm", 3, 0],
  ["crankcase_gap", "Gap to the crankcase", "mm", 3, 0], ["gas_force", "Gas force", "kN", 4, 0, 1e3],
  ["pin_force", "Largest rod force", "kN", 4, 0, 1e3], ["bearing_force", "Largest main bearing force", "kN", 4, -1, 1e3], ["film", "Oil film, least", "um", 3, 1],
  ["film_pressure", "Oil film, largest pressure", "MPa", 3, -1], ["mean_torque", "Mean torque of the engine", "N m", 4, 0],
  ["mean_pressure", "Indicated mean pressure", "bar", 3, 0], ["power", "Indicated power", "kW", 4, 0],
];
export const SOLVED = new Set(["torsion", "bending", "torsion_per_mass", "bending_per_mass", "fatigue_safety", "pin_fillet_safety", "journal_fillet_safety", "outlet_safety", "stress", "film", "film_pressure"]);
// Those that cells tell while a dimension is dragged, near enough to the last settled web.
const OF_CELLS = new Set(["torsion", "bending", "torsion_per_mass", "bending_per_mass"]), TOO_LARGE = "waits: its error would be too large";
// Gauges of what a design may leave out, each with its table.
export const OF_TABLE = { outlet_safety: "throw.drilling", film: "bearings", film_pressure: "bearings" };

// That of nearly equal webs scatters from mesh to mesh, where the errors of stiffness are alike.
export const SAFETIES = (name) => name.includes("safety") || name === "stress";
// Least safety against fatigue of a web that lasts, as `fatigue`, `shape` and `compare` say it.
export const FAILS_BELOW = 1;
// Gauges that rest on the stiffness of a throw are settled as well.
export const OF_STIFFNESS = new Set(["m53_pin", "m53_journal", "natural_frequency"]);

// What is known of one design alone: forgotten with every step, or with the design.
export const ofStep = () => ({ fresh: false, settledPicture: null, colours: [], dragging: false, place: null, point: null, spot: false, missing: null, coarse: {}, coarseTold: false, safety: { gauges: {}, error_percent: {} }, settledParts: [], settledWarnings: [] });
export const ofDesign = () => ({ ...ofStep(), live: {}, rings: {}, marks: {}, stiffness: "", originalStiffness: "", warnings: [], loadWarnings: [], notes: [], settled: {}, errors: {}, original: {}, polars: [], originalPolars: [], plots: [], originalPlots: [], shaftPlots: [], originalShaftPlots: [], madeWarnings: "", picture: null, ghostPicture: null, broken: [], refit: true });

export const state = { reference: null, ranges: {}, project: null, jobs: [], turns: [0], front: null, ghostFront: null, keepPitch: false, ...ofDesign() };

// No change is told between a stiffness in closed form and a settled one.
export const comparable = (name) => !OF_STIFFNESS.has(name) || [state.stiffness, state.originalStiffness].sort().join() !== "closed form,settled";

// A bound holds for the design that it was found for: that of the newest job on the step in hand. It is a share of
// that design on the cells of the proof, which are not quite as stiff and heavy as elements are.
export function boundOf(name) {
  if (state.dragging) return undefined;
  const jobs = state.jobs.filter((job) => job.step === state.project.steps[state.project.at].file);
  const found = jobs.map((job) => job.gauges).findLast((gauges) => gauges[`bound_${name}`] !== undefined) ?? {};
  const percent = found[`bound_percent_${name}`], own = SOLVED.has(name) && !state.fresh ? undefined : valueOf(name)[0];
  return percent === undefined ? found[`bound_${name}`] : own && (own * percent) / 100;
}

// What a limit of this quantity costs, in the words of the shape job whose result is the design in hand.
export function priceOf(name) {
  const what = state.project.steps[state.project.at].what, taken = state.project.variants.find((one) => what === `took ${one.name}`);
  const found = state.jobs.find((job) => taken && job.variant === taken.id)?.found ?? [];
  return state.dragging ? undefined : found.find((line) => line.startsWith(`1 % of ${name} `));
}

export const pick = (gauges) => Object.fromEntries(Object.entries(gauges).filter(([name]) => SOLVED.has(name)));

const parts = (key) => key.split(".").flatMap((word) => [word.split("[")[0], ...[...word.matchAll(/\[(\d+)\]/g)].map((m) => Number(m[1]))]);
export const valueAt = (key, data = state.project.data) => parts(key).reduce((at, part) => (at === undefined || at === null ? undefined : at[part]), data);

export function valueOf(name) {
  if (!SOLVED.has(name)) {
    if (state.broken.length && state.live[name] !== undefined) return [state.live[name], "stale: of the last web that broke no rule"];
    const settled = OF_STIFFNESS.has(name) && state.settledParts.includes("shaft") && !state.dragging && state.rings[name];
    const ring = state.rings[name] ?? "live, exact";
    return [state.live[name], settled && state.live[name] !== undefined ? ring.replace(/^[^;]*/, "settled stiffness of a throw") : ring];
  }
  const moving = state.dragging || !state.fresh;
  const estimate = moving || state.settled[name] === undefined ? state.safety.gauges[name] : undefined;
  if (estimate !== undefined) return [estimate, state.broken.length ? "stale: of the last web that broke no rule" : `live, error at most ${state.safety.error_percent[name].toFixed(1)} %`];
  if (moving && state.coarse?.[name] !== undefined) return [state.coarse[name], `coarse, error about ${state.coarseErrors[name].toFixed(1)} %`];
  if (moving && state.coarseTold && OF_CELLS.has(name)) return [undefined, TOO_LARGE];
  const value = state.settled[name], error = (state.errors ?? {})[name.replace("_per_mass", "")];
  if (value === undefined) return [undefined, state.broken.length ? "waits until no rule is broken" : "waits"];
  if (moving && SAFETIES(name)) return [undefined, state.broken.length ? "waits until no rule is broken" : TOO_LARGE];
  if (moving) return [value, "stale: of the last settled web"];
  return [value, `settled${error === undefined ? "" : `, error ${SAFETIES(name) ? "about" : "at most"} ${error.toFixed(1)} %`}`];
}

// Percent by which a gauge may be off, as far as that is known.
export function errorOf(name) {
  if (!SOLVED.has(name)) return 0;
  const errors = state.fresh && !state.dragging ? state.errors : SAFETIES(name) ? state.safety.error_percent : state.coarseErrors;
  return errors?.[name] ?? errors?.[name.replace("_per_mass", "")] ?? 0;
}

// Limits of a gauge, two for a range, each with whether it holds within the error; those of an unknown original are left out.
export function limitsOf(name, value) {
  const room = errorOf(name) / 100 + 1e-4;
  return (state.project.limits[name] ?? []).map((limit) => {
    const required = limit.percent ? (limit.value / 100) * state.original[name] : limit.value, slack = room * Math.abs(required);
    return { ...limit, required, holds: value !== undefined && (limit.sense === ">=" ? value >= required - slack : value <= required + slack) };
  }).filter((limit) => Number.isFinite(limit.required));
}

// A bar is in percent of the original; that of a quantity in percent of its own is in points of it, and one that passes 0 has none.
export const inPoints = (name) => name === "balance_factor";
export const changeOf = (name, value) => (inPoints(name) ? value - state.original[name] : 100 * (value / state.original[name] - 1));
