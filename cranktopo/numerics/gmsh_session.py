"""One gmsh session: opened quietly, closed or kept for a body, its errors as messages, its mesh read."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable, Hashable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError, ExitCode, lacks_memory, solver_error
from cranktopo.base.machine import check_addresses
from cranktopo.base.notes import at_work

DimTags = list[tuple[int, int]]
"""Dimensions and numbers of bodies of the CAD kernel."""

DELAUNAY = 5
"""Method for the triangles of bodies made of two halves: on a bore with two seams the usual one, the frontal
one, can refine without end, or be 2e-4 of the volume off."""
_TRIANGLE = 2
_ADDRESSES_MIB = 300.0
"""Memory of its library and a small model; where it cannot be had, it may end the process."""
_RESET = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGPIPE, signal.SIGTERM)
_SIGACTION = 512
"""Bytes that hold a `struct sigaction` of any platform."""
_ALONE = threading.RLock()
"""gmsh keeps one state for the whole process."""
_KEPT: dict[Hashable, Any] = {}
"""The body whose session is open, if any, and what built it."""
_KEEPERS: list[object] = []
"""Blocks that keep it; others of the process may use gmsh outside of them."""
_Built = TypeVar("_Built")


@contextmanager
def cad_session(what: str) -> Iterator[Any]:
    """Yield gmsh with a fresh model, which is gone afterwards; errors of gmsh become CranktopoError.

    Meshes are made by one thread, so that the same input gives the same mesh; sessions of other threads wait.
    """
    with _ALONE, at_work(f"CAD kernel: {what}"):
        _end_kept()
        gmsh = _opened(what)
        try:
            with _failures(gmsh, what):
                yield gmsh
        finally:
            gmsh.finalize()


@contextmanager
def with_option(name: str, value: float) -> Iterator[None]:
    """Set an option of gmsh for a block in an open session."""
    import gmsh

    before = gmsh.option.getNumber(name)
    gmsh.option.setNumber(name, value)
    try:
        yield
    finally:
        gmsh.option.setNumber(name, before)


def points_joined(within_mm: float) -> AbstractContextManager[None]:
    """Let the CAD kernel take points within a distance for one in the unions and cuts of a block."""
    return with_option("Geometry.ToleranceBoolean", within_mm)


@contextmanager
def keeping_bodies() -> Iterator[None]:
    """Keep the last body of the block's body sessions, of any thread: its next mesh builds it no more."""
    with _ALONE:
        _KEEPERS.append(None)
    try:
        yield
    finally:
        with _ALONE:
            _KEEPERS.pop()
            if not _KEEPERS:
                _end_kept()


@contextmanager
def body_session(what: str, body: Hashable, build: Callable[[Any], _Built]) -> Iterator[tuple[Any, _Built]]:
    """Yield gmsh with a body, not meshed, and what built it; as `cad_session`, but for the body.

    Kept by `keeping_bodies`, its next mesh is that of a new one.

    Args:
        body: what it is built from.
    """
    with _ALONE, at_work(f"CAD kernel: {what}"):
        kept = _end_kept(but=body)
        gmsh, ended = _gmsh() if kept else _opened(what), False
        try:
            with _failures(gmsh, what):
                built = kept[0] if kept else build(gmsh)
                yield gmsh, built
                gmsh.model.mesh.clear()
                for field in gmsh.model.mesh.field.list():
                    gmsh.model.mesh.field.remove(field)
            if _KEEPERS:
                _KEPT[body], ended = built, True
        finally:
            if not ended:
                gmsh.finalize()


def _end_kept(but: Hashable = None) -> list[Any]:
    """Close the session of the body that is open unless it is this one; return what built this one."""
    was_open, found = bool(_KEPT), [built for body, built in _KEPT.items() if body == but]
    _KEPT.clear()
    if was_open and not found:
        _gmsh().finalize()
    return found


def _opened(what: str) -> Any:
    check_addresses(what, _ADDRESSES_MIB)
    gmsh = _gmsh()
    with _kept_handlers():
        gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Geometry.OCCParallel", 1)  # booleans alone, which end the same
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    gmsh.model.add(what)
    return gmsh


@contextmanager
def _failures(gmsh: Any, what: str) -> Iterator[None]:
    """Turn errors of gmsh, which raises the bare class, into CranktopoError; anything else is a defect."""
    try:
        yield
    except CranktopoError:
        raise
    except Exception as error:
        if type(error) is not Exception:
            raise
        raise solver_error(
            f"{what}: gmsh failed: {str(error).strip() or gmsh.logger.getLastError()}.",
            "Change the dimensions slightly, or the size of elements or facets.",
        ) from None


def unless_it_fails(make: Callable[[], list[_Built]]) -> list[_Built]:
    """Return what is made in an open session, such as bodies; nothing where gmsh fails.

    It raises the bare class then; anything else is a defect.
    """
    try:
        return make()
    except Exception as error:
        if type(error) is not Exception:
            raise
        return []


@contextmanager
def _kept_handlers() -> Iterator[None]:
    """Keep what the process does on signals; gmsh resets it below Python, which does not notice.

    A SIGPIPE that Python no longer ignores ends a process whose reader has gone, in place of an error.

    By the C library, not by `signal.signal`: that works in the main thread alone.
    """
    libc, kept = ctypes.CDLL(None), {number: (ctypes.c_char * _SIGACTION)() for number in _RESET}
    for number, action in kept.items():
        libc.sigaction(number, None, action)
    try:
        yield
    finally:
        for number, action in kept.items():
            libc.sigaction(number, action, None)


@contextmanager
def quiet_stdout() -> Iterator[None]:
    """Silence OCC's reader and writer of STEP, which print to the process's stdout past any Python stream."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def _gmsh() -> Any:
    try:
        import gmsh
    except (ImportError, OSError) as error:  # OSError: a system library that gmsh loads is missing
        if lacks_memory(error):
            raise
        raise CranktopoError(
            f"gmsh cannot be loaded: {error}.",
            hint="'cranktopo doctor' says which line installs it.",
            code=ExitCode.MISSING_TOOL,
        ) from None
    return gmsh


def tetrahedra(gmsh: Any, element_type: int, corners: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return nodes (n, 3), mm, and elements (elements, corners) of gmsh's type; nodes are numbered from 0."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(element_type)
    if len(nodes) == 0:
        raise solver_error("mesh: no tetrahedra were made.", "Choose a smaller element size.")
    return coordinates.reshape(-1, 3), _numbers(tags)[nodes].reshape(-1, corners)


def triangles(gmsh: Any) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return vertices (n, 3), mm, and outward faces (m, 3) of the open session's surface mesh."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, corners = gmsh.model.mesh.getElementsByType(_TRIANGLE)
    return coordinates.reshape(-1, 3), _numbers(tags)[corners].reshape(-1, 3)


def _numbers(tags: NDArray[np.int64]) -> NDArray[np.int64]:
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags] = np.arange(len(tags))
    return number
