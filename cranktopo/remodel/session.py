"""One gmsh session: opened quietly, closed always, its errors turned into messages."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from cranktopo.errors import CranktopoError, ExitCode


@contextmanager
def cad_session(what: str) -> Iterator[Any]:
    """A fresh gmsh model, yielding the gmsh module; everything in it is gone afterwards.

    Single-threaded, so that the same input gives the same mesh.

    Args:
        what: what is being built, for the message.

    Raises:
        CranktopoError: gmsh failed inside the block.
    """
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.model.add("cranktopo")
        yield gmsh
    except CranktopoError:
        raise
    except Exception as error:
        if type(error) is not Exception:  # gmsh raises the bare class; anything else is a defect
            raise
        raise CranktopoError(
            f"{what}: gmsh failed: {str(error).strip() or gmsh.logger.getLastError()}.",
            hint="Change the dimensions slightly, or the element size.",
            code=ExitCode.SOLVER,
        ) from None
    finally:
        gmsh.finalize()
