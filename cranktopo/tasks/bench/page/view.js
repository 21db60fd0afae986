// 3D view: the first picture starts it, later ones replace the body.
import { $, make, plain } from "./base.js";
import { state } from "./state.js";

let viewer = null;

export function showPicture(number) {
  const wanted = $("colours").value, settled = state.settledPicture && !state.dragging;
  const colour = settled && wanted ? state.colours.findIndex((one) => one.name === wanted) : -1;
  const text = colour < 0 ? state.picture : state.settledPicture;
  if (!text) return;
  $("legend").textContent = colour >= 0 ? `Dark to yellow: ${state.colours[colour].legend}.`
    : !wanted ? "Blue: web. Grey: journals, and the original where it stands out."
      : settled ? "No colours of this: the design has no such load." : "The colours come when the safety has settled.";
  if (!viewer) return startViewer(text);
  viewer.show(text).then((drawn) => {
    if (!drawn) return;
    viewer.colour(colour);
    if (state.refit && !number) {
      viewer.refit();
      state.refit = false;
    }
    viewer.dataset.shown = String(number ?? 0); // of the drag that is painted
  });
  viewer.turns($("crank").checked ? state.turns : null);
  viewer.section($("section").checked ? sectionAt() : null);
  viewer.spot(state.spot && state.fresh && !state.dragging ? state.point : null);
}

// The place of the section, mm, on its slider, which goes from side to side of the web.
function sectionAt() {
  const slider = $("section-x"), half = Math.max(...state.front.paths.flatMap((path) => path.points.map(([x]) => Math.abs(x))));
  slider.disabled = false;
  [slider.min, slider.max] = [-half.toFixed(1), half.toFixed(1)];
  slider.setAttribute("aria-valuetext", `x = ${slider.value} mm`);
  return Number(slider.value);
}

// Turns the view to the place of the least safety, and marks it.
export function showPlace() {
  state.spot = true;
  viewer?.lookAt(state.point);
  showPicture();
}

function startViewer(text) {
  if ($("scene3d")) return;
  const holder = make("script", { id: "scene3d", type: "application/octet-stream" });
  holder.textContent = text;
  $("viewer").addEventListener("ready", () => {
    viewer = $("viewer");
    state.refit = true;
    showPicture();
    showGhost();
  });
  document.body.append(holder, make("script", { src: "viewer.js" }));
}

export function showGhost() {
  viewer?.ghost($("ghost").checked && state.ghostPicture && state.project?.at !== state.project?.original ? state.ghostPicture : null);
}
