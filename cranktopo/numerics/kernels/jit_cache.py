"""Machine code of kernels for the processor at hand, kept in the user's cache like XLA's programs."""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import jax
import numpy as np

from cranktopo.base.cache import private_cache

if TYPE_CHECKING:
    import llvmlite.binding as llvm

_FOLDER = "machine-code"  # versions before had one that others could read, "kernels"
_KEEPING = "jax_enable_compilation_cache"
_DIGEST_BYTES = 32
_engines: list[llvm.ExecutionEngine] = []  # machine code lives as long as its engine


def address_of(function: str, text: str) -> int:
    """Return the address of a function of a module, written for LLVM, as machine code for this processor.

    LLVM takes a tenth of a second for a kernel: its object files are kept.
    """
    import llvmlite.binding as llvm  # loads all of LLVM: only who solves needs it

    machine = _machine()
    kept = _kept(f"{llvm.llvm_version_info} {machine.triple} {_processor()} {text}")
    code = None if kept is None else _read(kept)
    if code is None:
        code = _compiled(text)
        if kept is not None:
            _keep(code, kept)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    return int(engine.get_function_address(function))


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


def _kept(made_from: str) -> Path | None:
    """File for the code made from a text; None where it is not wanted, or has no place that is the user's."""
    folder = private_cache(_FOLDER) if getattr(jax.config, _KEEPING) else None
    return None if folder is None else folder / f"{hashlib.sha256(made_from.encode()).hexdigest()[:32]}.o"


def _read(file: Path) -> bytes | None:
    try:
        found = file.read_bytes()
    except OSError:
        return None
    digest, code = found[:_DIGEST_BYTES], found[_DIGEST_BYTES:]
    return code if hashlib.sha256(code).digest() == digest else None


def _keep(code: bytes, file: Path) -> None:
    """Keep code where that is possible; a reader finds all of it or what was there before."""
    temporary = file.with_suffix(f".{os.getpid()}.tmp")
    with suppress(OSError):
        temporary.write_bytes(hashlib.sha256(code).digest() + code)
        temporary.replace(file)
