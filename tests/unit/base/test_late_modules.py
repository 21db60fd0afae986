"""What libraries import and hardly anybody uses is loaded by who uses it, and is then all there."""

from __future__ import annotations

import subprocess
import sys

CODE = """
import sys
from cranktopo.base.late_modules import load_late

load_late()
import numpy, scipy.fft

print("numpy.f2py.crackfortran" in sys.modules)
print(callable(numpy.f2py.run_main), "numpy.f2py.crackfortran" in sys.modules)
"""


def test_loaded_when_used() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "True", "True"]
