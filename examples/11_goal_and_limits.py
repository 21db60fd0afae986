"""A goal with limits: the lightest web that is 10 % stiffer in torsion and as stiff in bending."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from cranktopo import double_precision, load_scene, optimise_density, prepare, wanted, with_goal

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

scene = load_scene("mikron-iiic").with_optimise(resolution_mm=4.5, max_iterations=10)
scene = with_goal(scene, minimise="mass", limits=["torsion >= 110 %", "bending >= 100 %"])
for limit in wanted(scene).limits:
    print(f"{limit}{', by default' if limit.assumed else ''}")
with double_precision():
    optimum = optimise_density(prepare(scene))

history = optimum.state.history
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
left.plot([row.iteration for row in history], [row.goals[0] for row in history])
left.set(xlabel="iteration", xticks=range(0, len(history) + 1, 2))
left.set_ylabel("mass of the throw, kg", color="tab:blue")
broken = left.twinx()
broken.plot(
    [row.iteration for row in history], [100 * max(row.broken, 0) for row in history], color="tab:red"
)
broken.set_ylabel("worst limit is broken by, %", color="tab:red")
half = optimum.design.physical.mean(axis=2)  # over the thickness; the half x >= 0 is computed
right.imshow(np.concatenate([half[::-1], half]).T, origin="lower", cmap="Greys", vmin=0, vmax=1)
right.set(title="mean density", xticks=[], yticks=[])
figure.savefig(out / "11_goal_and_limits.png", dpi=100)
