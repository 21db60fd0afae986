"""Load cases of your own: unit loads beside those of the engine, and what the web gives way under them."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from cranktopo import LoadCase, MeshRequest, evaluate_target, load_cases, load_scene

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

scene = load_scene("mikron-iiic")
unit = load_cases(scene.model_copy(update={"engine": None}))  # without an engine: 1000 N and 1 N m
own = (
    LoadCase("hydraulic lock", "bending", radial_N=60_000.0, source="estimate of the cylinder's strength"),
    LoadCase("propeller strike", "torsion", torque_Nm=2_000.0, source="shear of the propeller bolts"),
)
found = evaluate_target("mikron-iiic", MeshRequest(element_size_mm=9.0))

moved = {}
for case in (*unit, *load_cases(scene), *own):
    if case.kind == "bending":
        moved[f"{case.label}, um"] = 1000 * case.radial_N / found.bending_N_per_mm
    if case.kind == "torsion":
        moved[f"{case.label}, mrad"] = 1000 * case.torque_Nm / found.torsion_Nm_per_rad
for name, value in moved.items():
    print(f"{name}: {value:.3g}")

figure, axes = plt.subplots(figsize=(6.5, 3), layout="constrained")
axes.bar_label(axes.barh(list(moved), list(moved.values())), fmt="%.3g", padding=3)
axes.set(xscale="log", xlim=(1e-3, 2000), xlabel="deflection of the crankpin, or twist of the throw")
axes.invert_yaxis()
figure.savefig(out / "03_own_load_case.svg")
