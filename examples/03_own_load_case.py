"""Load cases of your own: unit loads beside those of the engine, and what the web gives way under them."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from cranktopo import LoadCase, MeshRequest, evaluate_target, load_cases, load_scene, with_values

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

scene = load_scene("mikron-iiic")
unit = load_cases(with_values(scene, {"engine": None}))  # without an engine: 1000 N and 1 N m
own = (
    LoadCase(
        name="hydraulic lock", kind="bending", radial_N=60_000.0, source="estimate of the cylinder's strength"
    ),
    LoadCase(
        name="propeller strike", kind="torsion", torque_Nm=2_000.0, source="shear of the propeller bolts"
    ),
)
found = evaluate_target("mikron-iiic", MeshRequest(element_size_mm=9.0))

kinds = {  # unit of the movement, and the movement by a unit of the load
    "bending": ("deflection of the crankpin, um", 1000 / found.bending_N_per_mm),
    "torsion": ("twist of the throw, mrad", 1000 / found.torsion_Nm_per_rad),
}
figure, panels = plt.subplots(2, figsize=(6.5, 4), layout="constrained")
for axes, (kind, (label, per_unit)) in zip(panels, kinds.items(), strict=True):
    cases = [case for case in (*unit, *load_cases(scene), *own) if case.kind == kind]
    moved = [(case.radial_N or case.torque_Nm) * per_unit for case in cases]
    axes.bar_label(axes.barh([case.label for case in cases], moved), fmt="%.3g", padding=3)
    axes.set(xlabel=label, xlim=(0, 1.15 * max(moved)))
    axes.invert_yaxis()
figure.savefig(out / "03_own_load_case.svg")
