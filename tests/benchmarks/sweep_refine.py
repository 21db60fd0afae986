"""What refining only the front saves: python -m tests.benchmarks.sweep_refine [POINTS] [ACCURACY].

Sobol points of width, thickness and fillet of `mikron-iiic`: all at full accuracy (%), and coarse first.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from cranktopo import sweep

VARY = {"web.width_mm": "44:60", "web.thickness_mm": "17:21", "throw.crankpin.fillet_mm": "2:3"}


def main(points: int = 24, accuracy_percent: float = 0.5) -> None:
    """Print the table as Markdown."""
    print("| points | at full accuracy | s | front | picks |\n|---|---|---|---|---|")
    told = []
    with tempfile.TemporaryDirectory() as folder:
        for refine in ("all", "front"):
            began = time.perf_counter()
            frame = sweep(
                vary=VARY,
                sampling="sobol",
                samples=points,
                accuracy_percent=accuracy_percent,
                refine=refine,
                out=Path(folder) / refine,
            )
            seconds = time.perf_counter() - began
            full = len(frame) if refine == "all" else int((frame["accuracy"] == "full").sum())
            told.append((frame.attrs["front"], frame.attrs["picks"]))
            same = [
                "the same" if one == first else "others" for one, first in zip(told[-1], told[0], strict=True)
            ]
            shown = same if refine == "front" else [str(len(one)) for one in told[0]]
            print(f"| {len(frame)} | {full} | {seconds:.0f} | {shown[0]} | {shown[1]} |", flush=True)


if __name__ == "__main__":
    main(*(kind(text) for kind, text in zip((int, float), sys.argv[1:], strict=False)))
