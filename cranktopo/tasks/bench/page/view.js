// 3D view: the first picture starts it, later ones replace the body.
import { $, make, plain } from "./base.js";
import { state } from "./state.js";

let viewer = null;

export function showPicture(number) {
  const coloured = $("safety").checked && state.settledPicture && !state.dragging;
  const text = coloured ? state.settledPicture : state.picture;
  if (!text) return;
  $("legend").textContent = coloured ? `Colour: share of the fatigue strength that is used; yellow is the least safety, ${plain(state.settled.fatigue_safety, 3)}.`
    : $("safety").checked ? "The colours of the safety come when it has settled." : "Blue: web. Grey: journals, and the original where it stands out.";
  if (!viewer) return startViewer(text);
  viewer.show(text).then((drawn) => {
    if (!drawn) return;
    viewer.colour(coloured ? 0 : -1);
    if (state.refit && !number) {
      viewer.refit();
      state.refit = false;
    }
    viewer.dataset.shown = String(number ?? 0); // of the drag that is painted
  });
  viewer.turns($("crank").checked ? state.turns : null);
  viewer.section($("section").checked ? 0 : null);
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
