"""Tests; beside others each process has one core, on which more threads of BLAS would only wait."""

import os

if "PYTEST_XDIST_WORKER" in os.environ:  # read when NumPy is loaded, which comes after this package
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
