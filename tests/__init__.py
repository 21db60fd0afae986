"""Tests; beside each other each process has one core, for which threads of BLAS would only wait in a circle."""

import os

if "PYTEST_XDIST_WORKER" in os.environ:  # read when NumPy is loaded, which comes after this package
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
