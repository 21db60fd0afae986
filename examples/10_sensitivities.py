"""What a millimetre is worth: the exact change of mass and stiffness by each dimension of a web."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import tomlkit

from cranktopo import evaluate_sensitivities, load_scene

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True)
stations = -25 + 98 * (1 - np.cos(np.linspace(0, np.pi, 7))) / 2  # as `shape` and `remodel` place them
widths = [0.0, 18.0, 26.0, 28.0, 26.0, 18.0, 0.0]
data["web"] = {"thickness_mm": 19.0, "outline": "profile", "half_widths_mm": widths}
data["web"]["stations_mm"] = stations.round(2).tolist()
file = out / "profile.toml"
file.write_text(tomlkit.dumps(data))

table = evaluate_sensitivities(str(file), element_size_mm=9.0).table
figure, axes = plt.subplots(figsize=(6.5, 4), layout="constrained")
for shift, quantity in enumerate(("mass", "torsion", "bending")):
    worth = [dimension.per_unit_percent[quantity] for dimension in table.parameters]
    axes.barh([row + 0.25 * shift for row in range(len(worth))], worth, height=0.25, label=quantity)
axes.set_yticks([row + 0.25 for row in range(len(worth))], [dimension.name for dimension in table.parameters])
axes.set_xlabel("change by one millimetre more, %")
axes.invert_yaxis()
axes.legend()
figure.savefig(out / "10_sensitivities.svg")
