"""Two webs beside each other: a design is data, so a wider web is a copy with another number."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from cranktopo import Entry, MeshRequest, Target, compare, evaluate_target, load_scene, with_values

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

scene = load_scene("mikron-iiic")
wide = with_values(scene, {"web.width_mm": 60.0, "web.thickness_mm": 17.0})
targets = (Target("as it is", scene), Target("wide", wide))
coarse = MeshRequest(element_size_mm=9.0)  # for an example; without it, a tenth of the thinner journal
found = compare([Entry(evaluate_target(target, coarse)) for target in targets], baseline="as it is")

figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
for place, quantity in enumerate(found.quantities):
    bars = axes.barh(place, found.percent(1, quantity) - 100, color="tab:blue", height=0.6)
    axes.errorbar(bars[0].get_width(), place, xerr=found.change_error_percent(1, 0, quantity), color="black")
axes.set_yticks(range(len(found.quantities)), [quantity.label for quantity in found.quantities])
axes.axvline(0, color="black", linewidth=0.8)
axes.set_xlabel("change by the wide web with its error, %")
axes.invert_yaxis()
figure.savefig(out / "04_two_webs.svg")
