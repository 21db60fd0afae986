"""Compiled programs that the next process loads as they are, neither traced nor lowered again.

XLA's cache keeps what its compiler makes, but is asked by the text of a program: to have it, each process
traces and lowers, half a second for a multigrid solve. Here a program is asked for by all that it is made
from: the files of numerics and of its own package, the shapes of its arguments, the kernels and settings of
this process.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import threading
from collections.abc import Callable, Hashable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial, update_wrapper, wraps
from importlib.metadata import version
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

import jax
import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.seals import read_sealed_bytes, write_sealed_bytes
from cranktopo.numerics.kernels.registry import kernel_settings, known_kernels, make_known, on_processor
from cranktopo.numerics.precision import folder_of_programs
from cranktopo.numerics.source_files import NUMERICS, digest_of_sources

_R = TypeVar("_R")
_NAME_DIGITS = 32
_SETTINGS = "XLA_", "JAX_"
"""Beginnings of the variables of the environment that change programs."""
_TESTED = "0.10."
"""Versions of jaxlib with which this was tested; with others, all is as JAX has it."""
_LEVEL: dict[str, str | bool] = {"xla_backend_optimization_level": "1"}
"""Of LLVM's optimisation: compiled in four fifths of the time of level 3, and as fast."""
_WIDE = "jax_enable_x64"
_CACHE_HIT = "/jax/compilation_cache/cache_hits"


@dataclass(frozen=True)
class LoweredProgram:
    """A program that is ready but for what its compiler does, which leaves the interpreter alone.

    Attributes:
        out_info: shapes of its results.
        compile: makes it, keeps it and has calls find it.
    """

    out_info: Any
    compile: Callable[[], object]


class _Key(NamedTuple):
    """Structure, shapes and statics of a call, and whether numbers have 64 bits: the same for one program."""

    structure: Hashable
    shapes: tuple[Hashable, ...]
    statics: tuple[tuple[str, Hashable], ...]
    wide: bool


class KeptProgram(Generic[_R]):
    """A jitted function of arrays, and statics by name, whose programs are kept.

    Calls from within other programs, and on devices that are no processor, are JAX's own.
    """

    def __init__(self, function: Callable[..., _R], statics: Sequence[str], donated: Sequence[str]) -> None:
        self._function = function
        self._jit = partial(jax.jit, static_argnames=statics, donate_argnames=donated)
        self._jitted = self._jit(function)
        self._programs: dict[_Key, Callable[..., Any]] = {}
        update_wrapper(self, function)

    def __call__(self, *args: Any, **statics: Any) -> _R:
        """Return what the function does."""
        leaves, structure = jax.tree.flatten(args)
        if not (_ours() and _plain(leaves)):
            return self._jitted(*args, **statics)
        key = _key(leaves, structure, statics)
        if key not in self._programs:
            self._begun(key, args, statics).compile()
        found: _R = self._programs[key](*args)
        return found

    def begin(self, *args: Any, **statics: Any) -> LoweredProgram:
        """Load a program for arrays or shapes, or trace and lower it."""
        if not _ours():
            lowered = self._jitted.lower(*args, **statics)
            return LoweredProgram(lowered.out_info, lowered.compile)
        leaves, structure = jax.tree.flatten(args)
        return self._begun(_key(leaves, structure, statics), args, statics)

    def _begun(self, key: _Key, args: Any, statics: Mapping[str, Any]) -> LoweredProgram:
        name = f"{self._function.__name__}_{_digest_of_origin(self._function, key)}"
        folder = folder_of_programs()
        kept = None if folder is None else _loaded(folder / name)
        if kept is not None:
            self._programs[key] = kept.program
            return LoweredProgram(kept.out_info, lambda: None)
        lowered = self._jit(_renamed(self._function, name)).lower(*args, **statics)

        def finish() -> None:
            with _CacheHits() as hits:
                self._programs[key] = program = lowered.compile(compiler_options=_LEVEL)
            if folder is not None and not hits.any:
                _keep(folder / name, program, lowered.out_info)

        return LoweredProgram(lowered.out_info, finish)


def kept_program(
    *statics: str, donated: tuple[str, ...] = ()
) -> Callable[[Callable[..., _R]], KeptProgram[_R]]:
    """Return what jits a function, some arguments static (by name), the memory of some taken for results.

    What it is traced through stands in numerics and in the package of the function.
    """
    return lambda function: KeptProgram(function, statics, donated)


def _ours() -> bool:
    """Tell whether programs are compiled and kept here, not left to JAX."""
    return _jaxlib().startswith(_TESTED) and on_processor()


def _plain(leaves: list[Any]) -> bool:
    """Tell whether all are numbers on the first processor."""
    first = jax.devices()[0]
    return all(_lies_on(leaf, first) for leaf in leaves)


def _lies_on(leaf: Any, device: jax.Device) -> bool:
    if isinstance(leaf, np.ndarray | int | float):
        return True
    traced = isinstance(leaf, jax.core.Tracer)
    return not traced and isinstance(leaf, jax.Array) and leaf.devices() == {device}


def _key(leaves: list[Any], structure: Hashable, statics: Mapping[str, Any]) -> _Key:
    wide = bool(getattr(jax.config, _WIDE))
    return _Key(structure, tuple(map(_shape, leaves)), tuple(sorted(statics.items())), wide)


def _shape(leaf: Any) -> Hashable:
    if isinstance(leaf, int | float):
        return type(leaf).__name__
    return leaf.shape, str(leaf.dtype), getattr(leaf, "weak_type", False)


def _digest_of_origin(function: Callable[..., object], key: _Key) -> str:
    sources = digest_of_sources(NUMERICS, Path(function.__code__.co_filename).parent)
    made_from = key, kernel_settings(), _settings(), _jaxlib(), sources
    return hashlib.sha256(repr(made_from).encode()).hexdigest()[:_NAME_DIGITS]


def _settings() -> list[tuple[str, str]]:
    return sorted(pair for pair in os.environ.items() if pair[0].startswith(_SETTINGS))


@cache
def _jaxlib() -> str:
    return version("jaxlib")


def _renamed(function: Callable[..., _R], name: str) -> Callable[..., _R]:
    """Return a function under a name of its origin: XLA's cache then never has it from another one."""

    @wraps(function)
    def renamed(*args: Any, **statics: Any) -> _R:
        return function(*args, **statics)

    renamed.__name__ = name
    return renamed


class _CacheHits:
    """Watch for what XLA's cache has of what this thread compiles in a `with` block.

    What it loads from there cannot be kept once more: a part of the machine code is missing then.
    """

    def __init__(self) -> None:
        self.any = False
        self._thread = threading.get_ident()

    def __enter__(self) -> _CacheHits:
        jax.monitoring.register_event_listener(self._listen)
        return self

    def __exit__(self, *_: object) -> None:
        jax.monitoring.unregister_event_listener(self._listen)

    def _listen(self, event: str, **_: str | int) -> None:
        self.any |= event == _CACHE_HIT and threading.get_ident() == self._thread


class _Loaded(NamedTuple):
    program: Callable[..., Any]
    out_info: Any


def _loaded(file: Path) -> _Loaded | None:
    """Return a program and the shapes of its results; None where the file is missing, damaged or foreign."""
    from jax.experimental.serialize_executable import deserialize_and_load

    try:
        content = read_sealed_bytes(file)
        if content is None:
            return None
        kernels, out_info, payload, inputs, outputs = pickle.loads(content)
        make_known(kernels)
        _begin_lapack()
        program = deserialize_and_load(payload, inputs, outputs, execution_devices=jax.devices()[:1])
    except Exception:  # whatever a runtime raises that cannot load it: it is compiled again
        return None
    return _Loaded(program, out_info)


@cache
def _begin_lapack() -> None:
    """Have a program find LAPACK, which JAX looks for when it lowers one."""
    from jaxlib import lapack

    lapack.prepare_lapack_call("potrf_ffi", np.float64)  # type: ignore[no-untyped-call]


def _keep(file: Path, program: Any, out_info: Any) -> None:
    """Keep a program where that is possible; a reader finds all of it or what was there before."""
    from jax.experimental.serialize_executable import serialize

    with suppress(CranktopoError, ValueError, NotImplementedError):
        shapes = jax.tree.map(lambda out: jax.ShapeDtypeStruct(out.shape, out.dtype), out_info)
        content = pickle.dumps((known_kernels(), shapes, *serialize(program)))
        write_sealed_bytes(file, content)
