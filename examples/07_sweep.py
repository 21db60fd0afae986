"""A small sweep: four webs evaluated side by side, and the front between mass and torsional stiffness."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from cranktopo import sweep


def main(out: Path) -> None:
    """Sweep width and thickness of the web, and draw the table that comes back."""
    out.mkdir(parents=True, exist_ok=True)
    vary = {"web.width_mm": [50, 60], "web.thickness_mm": [17, 19]}
    table = sweep("mikron-iiic", vary, element_size_mm=9.0, workers=1, out=out / "sweep")
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    rising = table.sort_values("mass_kg")  # `on_front` counts bending as well
    front = rising[rising["torsion_Nm_per_rad"] == rising["torsion_Nm_per_rad"].cummax()]
    axes.plot(front["mass_kg"], front["torsion_Nm_per_rad"] / 1000, color="0.7", label="front")
    for thickness, webs in table.groupby("web.thickness_mm"):
        axes.plot(webs["mass_kg"], webs["torsion_Nm_per_rad"] / 1000, "o", label=f"{thickness:g} mm thick")
    axes.set(xlabel="mass of the throw, kg", ylabel="torsional stiffness, kN m/rad")
    axes.legend()
    figure.savefig(out / "07_sweep.svg")


if __name__ == "__main__":  # the worker processes import this file
    main(Path(sys.argv[1] if sys.argv[1:] else "examples/out"))
