"""Files for others: STEP for CAD, STL for a printer, and the drawing of the throw."""

import sys
from pathlib import Path

from cranktopo import export_solid, load_scene
from cranktopo.tasks.drawing.sheet import export_drawing

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

scene = load_scene("mikron-iiic-rounded")
for part, name in (("web", "web.step"), ("throw", "throw.stl")):
    volume = export_solid(scene, part, out / name)
    print(f"{name}: {volume:.0f} mm3, {(out / name).stat().st_size / 1000:.0f} kB")
export_drawing(scene, out / "12_export.png")  # or .pdf, .svg
