"""A page with a slider and a surface of 20,000 triangles that follows it: by a kit, or as the bench does it.

Started by `tests.studies.page_kits`, with the interpreter that has the kit: `page_kit_server.py KIT [THREE]`.
"""

from __future__ import annotations

import base64
import importlib
import math
import sys
from array import array
from pathlib import Path
from typing import Any

CELLS = 100
"""Cells along each side of the surface, two triangles each."""
PORT = 8642
_HEIGHTS = [math.sin(i / 9) * math.cos(k / 7) for i in range(CELLS + 1) for k in range(CELLS + 1)]
_READY = "ready"
DRAW = """
    const size = CELLS + 1, renderer = new THREE.WebGLRenderer(), scene = new THREE.Scene();
    const camera = new THREE.PerspectiveCamera(40, 1, 1, 1000);
    camera.position.set(50, -80, 120); camera.lookAt(50, 50, 0);
    renderer.setSize(500, 500); el.append(renderer.domElement);
    const geometry = new THREE.BufferGeometry(), points = new Float32Array(3 * size * size), faces = [];
    for (let i = 0; i < size; i++) for (let k = 0; k < size; k++) {
        points.set([i, k, 0], 3 * (i * size + k));
        const a = i * size + k;
        if (i < CELLS && k < CELLS) faces.push(a, a + size, a + 1, a + 1, a + size, a + size + 1);
    }
    geometry.setIndex(faces); geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    scene.add(new THREE.Mesh(geometry, new THREE.MeshNormalMaterial({ side: 2 })));
    let shown = 0;
    const update = (heights) => {
        for (let n = 0; n < heights.length; n++) points[3 * n + 2] = heights[n];
        geometry.attributes.position.needsUpdate = true; geometry.computeVertexNormals();
        renderer.render(scene, camera);
        requestAnimationFrame(() => (document.documentElement.dataset.shown = ++shown));
    };
""".replace("CELLS", str(CELLS))
"""Three.js of both kits: makes the surface in an element, and gives it other heights."""


def heights(value: float) -> bytes:
    """Return heights of the surface as 32-bit numbers."""
    return array("f", [value * height for height in _HEIGHTS]).tobytes()


def nicegui(three: Path) -> None:
    """Serve the page by NiceGUI: heights go to the page with a call of its JavaScript."""
    kit = importlib.import_module("nicegui")
    ui, app = kit.ui, kit.app
    app.add_static_file(local_file=three, url_path="/three.js")
    app.on_startup(lambda: print(_READY, flush=True))

    def page() -> None:
        ui.add_body_html(f"""<div id="scene"></div><script type="module">
            import {{ THREE }} from "/three.js"; const el = document.getElementById("scene"); {DRAW}
            const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
            window.bring = (text) => update(new Float32Array(bytes(text).buffer));
            window.bring("{base64.b64encode(heights(5)).decode()}");</script>""")

        def moved(event: Any) -> None:
            ui.run_javascript(f'window.bring("{base64.b64encode(heights(event.value)).decode()}")')

        ui.slider(min=0, max=10, step=0.1, value=5, on_change=moved)

    ui.page("/")(page)
    ui.run(host="127.0.0.1", port=PORT, show=False, reload=False, show_welcome_message=False)


def panel(three: Path) -> None:
    """Serve the page by Panel: heights are a property of a component, synchronised by Bokeh."""
    pn, param = importlib.import_module("panel"), importlib.import_module("param")
    base: Any = importlib.import_module("panel.custom").JSComponent
    body = f"""export async function render({{ model, el }}) {{
        const {{ THREE }} = await import(new URL("/lib/{three.name}", location.href).href); {DRAW}
        const bring = () => update(new Float32Array(model.heights));
        model.on("heights", bring); bring(); }}"""
    surface = type("Surface", (base,), {"heights": param.Bytes(), "_esm": body})

    def page() -> Any:
        shown = surface(heights=heights(5), width=500, height=500)
        slider = pn.widgets.FloatSlider(start=0, end=10, step=0.1, value=5)
        slider.param.watch(lambda event: setattr(shown, "heights", heights(event.new)), "value")
        return pn.Column(shown, slider)

    server = pn.serve(
        page, port=PORT, address="127.0.0.1", show=False, start=False, static_dirs={"lib": str(three.parent)}
    )
    server.start()
    server.io_loop.add_callback(print, _READY, flush=True)
    server.io_loop.start()


def own(_: Path) -> None:
    """Serve the page by Tornado and the 3D view of the bench, in the form that the bench sends a picture."""
    import asyncio

    import numpy as np
    from tornado.web import Application, RequestHandler
    from tornado.websocket import WebSocketHandler

    from cranktopo.numerics.surfaces.mesh import SurfaceMesh
    from cranktopo.report.shading import sharp_edges
    from cranktopo.report.viewer.scene3d import SCRIPT, Arrays, scaled

    size = CELLS + 1
    across = np.arange(size * size).reshape(size, size)
    a, b, c, d = (
        part.ravel() for part in (across[:-1, :-1], across[1:, :-1], across[:-1, 1:], across[1:, 1:])
    )
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([c, b, d], 1)])
    flat = np.stack([across // size, across % size], -1).reshape(-1, 2).astype(float)

    def picture(value: float) -> str:
        z = np.frombuffer(heights(value), np.float32).astype(float)
        mesh = SurfaceMesh(np.column_stack([flat, z]), faces)
        surface, slope = z.reshape(size, size), np.gradient(z.reshape(size, size))
        normals = np.stack([-slope[0], -slope[1], np.ones_like(surface)], -1).reshape(-1, 3)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        low, whole = np.array([0.0, 0.0, -10.0]), [100.0, 100.0, 20.0]
        arrays = Arrays()
        body = {
            "name": "surface", "half_pitch_mm": 10.0, "partner": 0, "low_mm": low.tolist(),
            "size_mm": whole, "sides_mm": [-20.0, 20.0],
            "positions": arrays.add(scaled((mesh.vertices_mm - low) / whole, 65535, np.uint16)),
            "normals": arrays.add(scaled(normals, 127, np.int8)),
            "faces": arrays.add(faces.astype(np.uint32)),
            "edges": arrays.add(sharp_edges(mesh.vertices_mm, faces)), "stress": [],
        }  # fmt: skip
        return arrays.packed_with({"bodies": [body], "first": 0, "stress": None, "steps": None}, quick=True)

    class Page(RequestHandler):
        def get(self) -> None:
            self.write(f"""<div id="viewer" data-follows><canvas style="width:500px;height:500px"></canvas>
            <input type="checkbox" data-whole></div><input type="range" min="0" max="10" step="0.1" value="5">
            <script id="scene3d" type="application/octet-stream">{picture(5)}</script><script>
            const box = document.getElementById("viewer"), page = document.documentElement;
            const talk = new WebSocket("ws://" + location.host + "/talk");
            let shown = 0;
            const painted = () => requestAnimationFrame(() => (page.dataset.shown = ++shown));
            box.addEventListener("ready", painted);
            talk.onmessage = ({{ data }}) => box.show(data).then(painted);
            document.querySelector("input[type=range]").oninput = (event) => talk.send(event.target.value);
            </script><script src="viewer.js"></script>""")

    class Script(RequestHandler):
        def get(self) -> None:
            self.write(SCRIPT.read_text(encoding="utf-8"))

    class Talk(WebSocketHandler):
        def on_message(self, message: str | bytes) -> None:
            self.write_message(picture(float(message)))

    async def serve() -> None:
        Application([("/", Page), ("/viewer.js", Script), ("/talk", Talk)]).listen(PORT, "127.0.0.1")
        print(_READY, flush=True)
        await asyncio.Event().wait()

    asyncio.run(serve())


if __name__ in {"__main__", "__mp_main__"}:
    {"nicegui": nicegui, "panel": panel, "own": own}[sys.argv[1]](
        Path(sys.argv[2]) if len(sys.argv) > 2 else Path()
    )
