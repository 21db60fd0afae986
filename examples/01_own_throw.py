"""A throw from a drawing: its dimensions in Python, checked, written as TOML, and the web drawn."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import tomlkit

from cranktopo import Scene, load_scene

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

journal = {"outer_diameter_mm": 50.0, "bore_diameter_mm": 20.0, "length_mm": 30.0, "fillet_mm": 3.0}
crankpin = journal | {"outer_diameter_mm": 46.0, "length_mm": 28.0}
outline = {"stations_mm": [-32.0, -10.0, 20.0, 48.0, 70.0], "half_widths_mm": [0.0, 34.0, 36.0, 32.0, 0.0]}
drawn = Scene.model_validate(
    {
        "name": "from-a-drawing",
        "throw": {"radius_mm": 40.0, "main_journal": journal, "crankpin": crankpin},
        "web": {"thickness_mm": 18.0, "outline": "profile"} | outline,
        "material": {"name": "42CrMo4"},
    }
)
file = out / "from-a-drawing.toml"
file.write_text(tomlkit.dumps(drawn.model_dump(mode="json", exclude_none=True)))
scene = load_scene(str(file))  # as the commands read it: a web that cannot be is refused here

y = np.linspace(*scene.web.y_range_mm(scene.throw.radius_mm), 400)
x = scene.web.half_width_mm(scene.throw.radius_mm, y)
figure, axes = plt.subplots(figsize=(4, 5), layout="constrained")
axes.fill_betweenx(y, -x, x, color="0.85", edgecolor="black")
behind, front = scene.throw.main_journal, scene.throw.crankpin
for centre, part, line in ((0.0, behind, "--"), (scene.throw.radius_mm, front, "-")):
    axes.add_patch(plt.Circle((0.0, centre), part.outer_diameter_mm / 2, fill=False, linestyle=line))
    axes.add_patch(plt.Circle((0.0, centre), part.bore_diameter_mm / 2, facecolor="white", edgecolor="black"))
axes.set(aspect="equal", xlabel="x, mm", ylabel="y along the throw, mm", title=scene.name)
figure.savefig(out / "01_own_throw.svg")
