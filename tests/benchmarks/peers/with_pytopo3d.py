"""The cantilever of `tests.studies.cantilever` in PyTopo3D: its default problem and its direct solver.

Runs in the peers' environment, without cranktopo: `python with_pytopo3d.py NX NY NZ ITERATIONS DENSITY.npy`.
"""

import json
import logging
import resource
import sys
import time

import matplotlib
import numpy as np

matplotlib.use("Agg")

import itertools

from pytopo3d.core import optimizer


def main() -> None:
    """Save the last physical density [x, y, z]; print seconds of every iteration and peak memory as JSON."""
    nx, ny, nz, iterations = (int(a) for a in sys.argv[1:5])
    logging.disable(logging.CRITICAL)
    began = []

    class Timed(optimizer.ComplianceEvaluator):
        """Notes when each design is evaluated: a design iteration starts here."""

        def evaluate(self, *arguments):
            began.append(time.perf_counter())
            return super().evaluate(*arguments)

    optimizer.ComplianceEvaluator = Timed
    density = optimizer.top3d(nx, ny, nz, 0.3, 3.0, 1.5, 0.0, tolx=0.0, maxloop=iterations)
    began.append(time.perf_counter())
    np.save(sys.argv[5], density.transpose(1, 0, 2))
    seconds = [b - a for a, b in itertools.pairwise(began)]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"seconds": seconds, "peak_MiB": peak}))


if __name__ == "__main__":
    main()
