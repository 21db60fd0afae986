"""The loads over the working cycle: curves as CSV, read with pandas, and drawn for two speeds."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from cranktopo import load_scene, write_load_curves

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

write_load_curves(load_scene("mikron-iiic"), out / "loads.csv", speeds_rpm=[1400.0, 2800.0])
curves = pd.read_csv(out / "loads.csv")

figure, (above, below) = plt.subplots(2, sharex=True, figsize=(6, 5), layout="constrained")
for speed, curve in curves.groupby("speed_rpm"):
    above.plot(curve["angle_deg"], curve["radial_force_N"] / 1000, label=f"{speed:g} rpm")
    below.plot(curve["angle_deg"], curve["torque_Nm"])
above.set_ylabel("radial force, kN")
above.legend()
below.set(ylabel="torque of one throw, N m", xlabel="crank angle, deg", xticks=range(0, 721, 90))
figure.savefig(out / "02_loads.svg")
