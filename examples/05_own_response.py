"""A response of your own with its gradient: where material keeps the crankpin from moving aside."""

import sys
from pathlib import Path

import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np

from cranktopo import double_precision, load_scene, prepare
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.loop import init
from cranktopo.tasks.density.material import physical_density, relative_moduli
from cranktopo.tasks.density.model import pin_weights
from cranktopo.tasks.density.response import displacements

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

scene = load_scene("mikron-iiic").with_optimise(resolution_mm=4.5)
ready = prepare(scene.with_optimise(process="free", draft_deg=0))  # a die would tie cells to each other
with double_precision():
    problem = build_problem(ready.scene, ready.domain, ready.cases)
    state = init(problem)  # the uniform density that an optimisation begins with
    crankpin = pin_weights(ready.domain)  # displacements mean something at material alone
    torsion = [case.name for case in problem.model.cases].index("torsion")

    def shift_mm(x):
        """Mean motion of the crankpin across the throw under the torque, mm."""
        density = physical_density(problem.density_chain, x, state.beta)
        moved = displacements(problem.model, relative_moduli(problem.density_chain, density))
        return jnp.sum(crankpin * moved[torsion, 0])

    value, gradient = map(np.asarray, jax.value_and_grad(shift_mm)(jnp.asarray(state.x)))
print(f"{value:.4f} mm; one derivative for each of the {gradient.size} design variables")

middle = 1000 * gradient.mean(axis=2)  # over the thickness; the half x >= 0 is computed
both = np.concatenate([middle[::-1], middle]).T
limit = abs(both).max()
figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
image = axes.imshow(both, origin="lower", cmap="RdBu_r", vmin=-limit, vmax=limit)
figure.colorbar(image, label="shift per density of a cell, um")
axes.set(xlabel="cell across the throw", ylabel="cell along the throw", title=f"shift {1000 * value:.1f} um")
figure.savefig(out / "05_own_response.png", dpi=100)
