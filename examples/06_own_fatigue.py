"""A fatigue judgement of your own: Gerber's parabola on the stresses of every node of the fillets."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from cranktopo import assess_fatigue, load_scene

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
out.mkdir(parents=True, exist_ok=True)

(field,) = assess_fatigue(["mikron-iiic"], fillet_fraction=1.0).fields  # 0.17 for a result to rely on
fillet = field.model.on_journal | field.model.on_pin
amplitude, mean = field.amplitude_MPa[:, fillet].ravel(), field.mean_MPa[:, fillet].ravel()
steel = load_scene("mikron-iiic").material
strength, ultimate = steel.fatigue_tension_MPa, steel.ultimate_MPa

# amplitude / strength * n + (mean / ultimate * n)^2 = 1, solved for the safety n
a, b = (np.maximum(mean, 0) / ultimate) ** 2, amplitude / strength
safety = 2 / (b + np.sqrt(b**2 + 4 * a))
print(f"Gerber {safety.min():.2f}, local stress analysis {min(field.fillet_safety.values()):.2f}")

line = np.linspace(0, ultimate, 100)
figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
dots = axes.scatter(mean, amplitude, c=safety, s=5, vmin=safety.min(), vmax=10)
figure.colorbar(dots, label="safety by Gerber", extend="max")
axes.plot(line, strength * (1 - (line / ultimate) ** 2), color="black", label="Gerber")
axes.set(xlabel="mean stress, MPa", ylabel="stress amplitude, MPa", ylim=(0, None))
axes.legend()
figure.savefig(out / "06_own_fatigue.png", dpi=100)
