"""Machine code of functions that are written for LLVM, kept in the user's cache like XLA's programs.

Without JAX, so that a second process can make it while the first one loads JAX.
"""

from __future__ import annotations

import hashlib
import os
import sys
import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.machine import private_cache
from cranktopo.base.seals import read_sealed_bytes, write_sealed_bytes

if TYPE_CHECKING:
    import llvmlite.binding as llvm


_FOLDER = "machine-code"  # versions before had one that others could read, "kernels"
_KEEPING = "jax_enable_compilation_cache"
_NO = frozenset({"n", "no", "f", "false", "off", "0"})
"""Values of a variable of the environment that JAX takes for no."""
_PATIENCE_S, _PAUSE_S = 3.0, 0.01
"""Longest wait for another process, ten times what a kernel takes, and the time between two looks."""
_engines: list[llvm.ExecutionEngine] = []  # machine code lives as long as its engine


def address_of(function: str, origin: Hashable, text: Callable[[], str]) -> int:
    """Return the address of a function of a module, written for LLVM, as machine code for this processor.

    LLVM takes a tenth of a second for a kernel: object files are kept.

    Args:
        origin: what the text is made from, the same for two processes that would write the same one.
    """
    import llvmlite.binding as llvm  # loads all of LLVM: only who solves needs it

    code = code_of(origin, text)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    return int(engine.get_function_address(function))


def code_of(origin: Hashable, text: Callable[[], str]) -> bytes:
    """Return the object file of a module: as it is kept, made by another process meanwhile, or made here."""
    import llvmlite.binding as llvm

    kept = _kept(f"{llvm.llvm_version_info} {_machine().triple} {_processor()} {origin!r}")
    if kept is None:
        return _compiled(text())
    code = read_sealed_bytes(kept)
    if code is not None:
        return code
    with _one_process(kept.parent):
        code = read_sealed_bytes(kept)
        if code is None:
            code = _compiled(text())
            _keep(code, kept)
        return code


def with_target(text: str) -> str:
    """Return a text with this processor and its layout of data, by which LLVM optimises what is compiled."""
    machine = _machine()
    return f'target datalayout = "{machine.target_data}"\ntarget triple = "{machine.triple}"\n{text}'


def can_be_kept() -> bool:
    """Tell whether code is kept for the next process."""
    return _folder() is not None


def vector_width(precision: str) -> int:
    """Return the numbers in a vector register of this processor; of 256 bits where it has no longer ones."""
    import llvmlite.binding as llvm

    wide = llvm.get_host_cpu_features().get("avx512f", False)
    return (64 if wide else 32) // np.dtype(precision).itemsize


def _compiled(text: str) -> bytes:
    import llvmlite.binding as llvm

    machine, module = _machine(), llvm.parse_assembly(text)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def _machine() -> llvm.TargetMachine:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    name, features = _processor()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(cpu=name, features=features, opt=3, jit=True)


@cache
def _processor() -> tuple[str, str]:
    import llvmlite.binding as llvm

    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _kept(source: str) -> Path | None:
    """File for the code of a source; None where it is not wanted, or has no place that is the user's."""
    folder = _folder()
    return None if folder is None else folder / f"{hashlib.sha256(source.encode()).hexdigest()[:32]}.o"


def _folder() -> Path | None:
    return private_cache(_FOLDER) if _keeping() else None


def _keeping() -> bool:
    """Tell whether programs are kept, as JAX has it, or will have it once it is loaded."""
    jax = sys.modules.get("jax")
    if jax is not None:
        return bool(getattr(jax.config, _KEEPING))
    return os.environ.get(_KEEPING.upper(), "").lower() not in _NO


def _keep(code: bytes, file: Path) -> None:
    """Keep code where that is possible; a reader finds all of it or what was there before."""
    with suppress(CranktopoError):
        write_sealed_bytes(file, code)


@contextmanager
def _one_process(folder: Path) -> Iterator[None]:
    """Hold a folder, so that two processes do not make the same code at once.

    Whoever does not get it in time goes on without: that costs time, and nothing else.
    """
    try:
        import fcntl

        place = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):
        yield
        return
    try:
        until = time.monotonic() + _PATIENCE_S
        while time.monotonic() < until:
            try:
                fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                time.sleep(_PAUSE_S)
            except OSError:  # a file system without locks
                break
        yield
    finally:
        os.close(place)
