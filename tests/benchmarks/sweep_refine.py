"""What refining only the front saves: python -m tests.benchmarks.sweep_refine [POINTS] [ACCURACY].

Sobol points of `mikron-iiic-plain`, all at full accuracy (%), and coarse first: once where nearly every point
trades mass for stiffness, so that nearly all are on the front, and once with a crankpin that costs both.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import pandas

from cranktopo import sweep

WEB = {"web.width_mm": "44:60", "web.thickness_mm": "17:21"}
CASES = {
    "web and fillet": {**WEB, "throw.crankpin.fillet_mm": "2:3"},
    "web and pin": {**WEB, "throw.crankpin.length_mm": "36:44"},
}


def main(points: int = 24, accuracy_percent: float = 0.5) -> None:
    """Print the table as Markdown."""
    print("| varied | points | at full accuracy | s | front | picks |\n|---|---|---|---|---|---|")
    for name, vary in CASES.items():
        told = []
        for refine in ("all", "front"):
            began = time.perf_counter()
            frame = swept(vary, points, accuracy_percent, refine)
            seconds = time.perf_counter() - began
            full = len(frame) if refine == "all" else int((frame["accuracy"] == "full").sum())
            told.append((frame.attrs["front"], frame.attrs["picks"]))
            shown = [str(len(one)) for one in told[0]]
            if refine == "front":
                pairs = zip(told[1], told[0], strict=True)
                shown = ["the same" if one == first else "others" for one, first in pairs]
            print(f"| {name} | {len(frame)} | {full} | {seconds:.0f} | {shown[0]} | {shown[1]} |", flush=True)


def swept(vary: dict[str, str], points: int, accuracy_percent: float, refine: str) -> pandas.DataFrame:
    """One row per point."""
    with tempfile.TemporaryDirectory() as folder:
        return sweep(
            vary=vary,
            sampling="sobol",
            samples=points,
            accuracy_percent=accuracy_percent,
            refine=refine,
            out=Path(folder) / refine,
        )


if __name__ == "__main__":
    main(*(kind(text) for kind, text in zip((int, float), sys.argv[1:], strict=False)))
