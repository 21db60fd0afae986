"""How well a known web comes back from its exact solid: python -m tests.benchmarks.remodel_recovery [MM...].

Initial guesses are scattered by 1 mm (or degree) about the known parameters. One row per parameter, one
column per cell size: the difference in percent, the absolute one in brackets.
"""

from __future__ import annotations

import sys

import numpy as np

from tests.unit.refit.remodel_cases import WHOLE, recovered, values_of


def main(cells_mm: list[float]) -> None:
    """Print the table."""
    found, true = [recovered(cell) for cell in cells_mm], values_of(WHOLE)
    print("| parameter | known | " + " | ".join(f"{cell:g} mm cells" for cell in cells_mm) + " |")
    print("|---|---|" + "---|" * len(cells_mm))
    for i, name in enumerate(WHOLE.names):
        cells = [f"{100 * (v[i] / true[i] - 1):+.2f} % ({v[i] - true[i]:+.3f})" for v in found]
        print(f"| {name} | {true[i]:g} | " + " | ".join(cells) + " |")
    worst = [f"{100 * np.abs(v / true - 1).max():.2f} %" for v in found]
    print("| largest | | " + " | ".join(worst) + " |")


if __name__ == "__main__":
    main([float(text) for text in sys.argv[1:]] or [1.0, 0.5])
