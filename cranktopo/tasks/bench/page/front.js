// Front view and the section beside it: strokes in mm, y up; handles are dimensions.
import { $, make, unitOf, words } from "./base.js";
import { state } from "./state.js";
import { reveal } from "./forms.js";
import { lockOf, lockShape, lockTitle, toggleLock } from "./lock.js";
import { drag, edit } from "./talk.js";

// The section stands to the right of front view and original; it stays there while a dimension is dragged.
let sideAt = 0;
const NAMED_FROM = 520; // Width, px, from which names of the section have room; in less they are shown one by one.
function beside({ paths, side, ...rest }) {
  const moved = side.paths.map((path) => ({ ...path, points: path.points.map(([x, y]) => [x + sideAt, y]) }));
  const handles = side.handles.map((one) => ({ ...one, at: [one.at[0] + sideAt, one.at[1]], aside: true }));
  return { ...rest, paths: [...paths, ...moved], handles: [...rest.handles, ...handles] };
}

function placeSide() {
  const points = [state.front, state.ghostFront ?? state.front].flatMap((view) => view.paths.flatMap((path) => path.points)), ys = points.map(([, y]) => y);
  sideAt = Math.max(...points.map(([x]) => x)) + 0.2 * (Math.max(...ys) - Math.min(...ys));
}

export function showFront() {
  const svg = $("front"), moving = svg.dataset.held || state.dragging;
  if (state.front && !(moving && state.frontDrawn)) placeSide();
  const view = state.front && beside(state.front);
  if (!view || ((svg.dataset.held || state.dragging) && state.frontDrawn)) return view && moveFront(svg, view);
  state.frontDrawn = true;
  const points = view.paths.flatMap((path) => path.points).concat(view.circles.flatMap((c) => [[c.at[0] - c.radius, c.at[1] - c.radius], [c.at[0] + c.radius, c.at[1] + c.radius]]));
  const [xs, ys] = [0, 1].map((i) => points.map((p) => p[i]));
  const pad = 0.12 * (Math.max(...ys) - Math.min(...ys));
  const box = [Math.min(...xs) - pad, -Math.max(...ys) - pad, Math.max(...xs) - Math.min(...xs) + 2 * pad, Math.max(...ys) - Math.min(...ys) + 2 * pad];
  svg.setAttribute("viewBox", box.join(" "));
  const scale = Math.max(box[2] / Math.max(svg.clientWidth, 100), box[3] / Math.max(svg.clientHeight, 100));
  svg.dataset.scale = scale;
  svg.dataset.start = box[0] + box[2] / 2 - (scale * Math.max(svg.clientWidth, 100)) / 2;
  svg.dataset.end = box[0] + box[2] / 2 + (scale * Math.max(svg.clientWidth, 100)) / 2;
  const held = document.activeElement, part = held?.classList.contains("lock") ? ".lock" : ".handle";
  svg.replaceChildren(make("g", {}), ...view.handles.map((handle) => handleOf(handle)));
  moveFront(svg, view);
  if (held?.dataset.handleKey) svg.querySelector(`${part}[data-handle-key="${CSS.escape(held.dataset.handleKey)}"]`)?.focus({ preventScroll: true });
}

function moveFront(svg, view) {
  const line = (path, kind = path.kind) => make("path", { class: kind, d: `M${path.points.map(([x, y]) => `${x},${-y}`).join("L")}${path.closed ? "Z" : ""}` });
  const round = (c, kind = c.kind) => make("circle", { class: kind, cx: c.at[0], cy: -c.at[1], r: c.radius });
  const ghost = state.project?.at !== state.project?.original || state.dragging ? state.ghostFront : null;
  const ghosts = ghost && $("ghost").checked ? beside(ghost).paths.filter((p) => p.kind === "web").map((p) => line(p, "ghost")) : [];
  svg.firstChild.replaceChildren(...view.room.map((p) => line(p)), ...view.paths.map((p) => line(p)), ...view.circles.map((c) => round(c)), ...ghosts, ...view.handles.flatMap(wayOf).map((p) => line(p)));
  const byKey = Object.fromEntries(view.handles.map((handle) => [handle.key, handle])), written = [];
  const scale = Number(svg.dataset.scale), letter = 0.8 * scale * parseFloat(getComputedStyle(document.documentElement).fontSize);
  for (const node of svg.querySelectorAll("[data-handle]")) {
    const handle = byKey[node.dataset.handle];
    const quiet = handle && handle.aside && svg.clientWidth < NAMED_FROM;
    node.classList.toggle("quiet", Boolean(quiet));
    if (handle) placeHandle(node, handle, scale, letter, quiet ? [] : written);
  }
}

// The way that `shape` may move a handle: none where it keeps the dimension.
function wayOf({ key, value, at, way, per_mm: perMm }) {
  const limits = lockOf(key)?.limits, place = (limit) => at.map((x, i) => x + (way[i] * (limit - value)) / perMm);
  return limits ? [{ points: limits.map(place), kind: "free" }] : [];
}

// Of a dimension, short: "crankpin \u2300", "throw radius", "pocket 1 y".
function nameOf(key) {
  const [table, name] = key.split(".").slice(-2);
  if (name === "outer_diameter_mm") return `${words(table)} \u2300`;
  const place = words(table.replace(/\[(\d+)\]/, (_, number) => ` ${Number(number) + 1}`));
  return table === "web" ? words(name) : `${place} ${words(name)}`;
}

// Lines by which a name is moved up or down until it stands on no other.
const WAYS = [0, -1, 1, -2, 2, -3, 3];
function freeLine(start, end, y, letter, written) {
  const free = (way) => written.every((one) => end < one.start || start > one.end || Math.abs(y + way * letter - one.y) >= letter);
  const found = y + letter * (WAYS.find(free) ?? 0);
  written.push({ start, end, y: found });
  return found;
}

function placeHandle(node, handle, scale, letter, written) {
  const [dot, text, lock] = node.children, [x, y] = [handle.at[0], -handle.at[1]];
  dot.setAttribute("cx", x);
  dot.setAttribute("cy", y);
  dot.setAttribute("r", 7 * scale);
  dot.setAttribute("aria-valuenow", handle.value.toFixed(2));
  dot.setAttribute("aria-valuetext", `${handle.value.toFixed(2)} ${unitOf(handle.key)}`);
  const name = `${nameOf(handle.key)} ${handle.value.toFixed(1)}`;
  const width = 0.55 * letter * name.length, [start, end] = ["start", "end"].map((edge) => Number($("front").dataset[edge]));
  const right = x + 10 * scale + width > end, neither = right && x - 10 * scale - width < start;
  const at = neither ? Math.max(start, end - width) : x + (right ? -10 : 10) * scale, from = right && !neither ? at - width : at;
  text.setAttribute("x", at);
  text.setAttribute("y", freeLine(from, from + width, y - (neither ? 14 : 8) * scale, letter, written));
  text.setAttribute("text-anchor", right && !neither ? "end" : "start");
  text.style.fontSize = `${letter}px`;
  text.style.strokeWidth = `${3 * scale}px`;
  text.textContent = name;
  lock?.setAttribute("transform", `translate(${x + (right && !neither ? -22 : 8) * scale} ${y + 2 * scale}) scale(${0.9 * scale})`);
  node.handle = handle;
}

// The lock below the name of a dimension.
function lockMark(key, name) {
  const lock = lockOf(key), press = () => toggleLock(lock, name);
  if (!lock) return [];
  const keyed = (event) => ["Enter", " "].includes(event.key) && (event.preventDefault(), press());
  return [make("g", { class: "lock", role: "button", tabindex: "0", "data-handle-key": key, "aria-pressed": String(!lock.limits), "aria-label": `${name} on the drawing: keep as it is`, onclick: press, onkeydown: keyed },
    make("title", {}, lockTitle(lock)), make("rect", { class: "hit", x: -3, y: -1, width: 22, height: 20 }), ...lockShape(lock.limits))];
}

let pressed = { key: "", at: 0 };
function handleOf(handle) {
  const name = words(handle.key.replaceAll(".", " "));
  const dot = make("circle", { class: "handle", tabindex: "0", role: "slider", "aria-label": name, "data-handle-key": handle.key });
  const node = make("g", { "data-handle": handle.key }, dot, make("text", {}), ...lockMark(handle.key, name));
  const svg = $("front");
  let held = null, value = 0;
  const move = (to) => {
    value = Number(to.toFixed(unitOf(handle.key) === "deg" ? 1 : 2));
    const number = document.querySelector(`#tree input[data-key="${CSS.escape(handle.key)}"]`);
    if (number) number.value = value;
    drag({ [handle.key]: value });
  };
  const release = () => {
    if (held === null) return;
    held = null;
    delete svg.dataset.held;
    edit({ [handle.key]: value }, `${name}: ${value} ${unitOf(handle.key)}`, true);
  };
  dot.addEventListener("pointerdown", (event) => {
    dot.setPointerCapture(event.pointerId);
    held = { x: event.clientX, y: event.clientY, from: node.handle.value };
    value = held.from;
    svg.dataset.held = handle.key;
    event.preventDefault();
    dot.focus();
  });
  dot.addEventListener("pointermove", (event) => {
    if (!held) return;
    const scale = Number(svg.dataset.scale), [wx, wy] = handle.way;
    const along = ((event.clientX - held.x) * wx - (event.clientY - held.y) * wy) * scale;
    move(held.from + along * handle.per_mm);
  });
  dot.addEventListener("pointerup", (event) => {
    const twice = pressed.key === handle.key && event.timeStamp - pressed.at < 400; // handles are made anew in between
    pressed = { key: handle.key, at: event.timeStamp };
    release();
    if (twice) reveal(handle.key, true);
  });
  dot.addEventListener("pointercancel", release);
  dot.addEventListener("keydown", (event) => {
    const step = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!step) return;
    event.preventDefault();
    if (held === null) value = node.handle.value;
    held = { from: value, key: true };
    svg.dataset.held = handle.key;
    move(value + step * (event.shiftKey ? 0.1 : 0.5));
  });
  dot.addEventListener("keyup", (event) => event.key.startsWith("Arrow") || event.key.startsWith("Page") ? release() : null);
  dot.addEventListener("blur", release);
  return node;
}
