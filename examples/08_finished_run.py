"""A finished run read again: metrics.json and history.csv are plain files for any tool."""

import json
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from cranktopo import load_scene, optimise_design

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
run = out / "run"
if not run.is_dir():
    optimise_design(load_scene("mikron-iiic").with_optimise(resolution_mm=4.5, max_iterations=20), out=run)

metrics = json.loads((run / "metrics.json").read_text())
history = pd.read_csv(run / "history.csv", index_col="iteration")
gain = metrics["original_web"]["gain_of_stiffness_per_mass_percent"]

figure, (above, below) = plt.subplots(2, sharex=True, figsize=(6, 5), layout="constrained")
for case in metrics["load_cases"]:
    work = history[f"{case}_compliance_N_mm"]
    above.plot(work / work.iloc[-1], label=f"{case}: {gain[case]:+.1f} % stiffness per mass")
above.set(ylabel="compliance over the last", yscale="log", title=f"{metrics['design']}: {metrics['status']}")
above.legend()
below.plot(history["greyness"], color="black")
below.set(xlabel="iteration", ylabel="greyness", xticks=range(0, len(history) + 1, 4))
figure.savefig(out / "08_finished_run.svg")
