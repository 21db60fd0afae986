"""Cylinders of an engine that do not fire: taken away, asked for in place of the scene's, and in words."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.checks.engine import check_misfire
from cranktopo.design.engine import Gas
from cranktopo.design.schema import Scene

MIRRORED = "measured compression mirrored about top dead centre (assumed)"


def all_firing(scene: Scene) -> Scene:
    """Return the scene with an engine whose cylinders all fire: that of the load cases of one throw."""
    return _misfiring(scene, ()) if misfire(scene) else scene


def misfire(scene: Scene) -> tuple[int, ...]:
    """Return the numbers of the cylinders that do not fire."""
    return scene.engine.misfire if scene.engine else ()


def with_misfire(scene: Scene, cylinders: Sequence[int]) -> Scene:
    """Return the scene with other cylinders that do not fire, as `--misfire` gives them; of none itself.

    Raises:
        CranktopoError: no engine, no pressures, or cylinders that it does not have.
    """
    if not cylinders:
        return scene
    if scene.engine is None:
        raise CranktopoError(
            "--misfire: the scene has no [engine].", hint="Leave it out.", code=ExitCode.USAGE
        )
    found = _misfiring(scene, tuple(cylinders))
    assert found.engine is not None
    try:
        check_misfire(found.engine, "--misfire")
    except CranktopoError as error:
        raise CranktopoError(error.message, hint=error.hint, code=ExitCode.USAGE) from None
    return found


def misfire_words(scene: Scene) -> str:
    """Return a sentence on the cylinders that do not fire and their pressure; empty where all fire."""
    silent = misfire(scene)
    if not silent or scene.engine is None or scene.engine.gas is None:
        return ""
    return f"{silent_words(silent)}: {motored_words(scene.engine.gas)}."


def silent_words(cylinders: Sequence[int]) -> str:
    """Return which cylinders do not fire."""
    *most, last = map(str, sorted(cylinders))
    if not most:
        return f"Cylinder {last} does not fire"
    return f"Cylinders {', '.join(most)} and {last} do not fire"


def motored_words(gas: Gas) -> str:
    """Return where the pressure of a cylinder that does not fire comes from."""
    modelled = gas.peak_pressure_MPa is not None or any(at.file is None for at in gas.map)
    mirrored = f"{MIRRORED}, until {gas.exhaust_opening_deg:g} deg"
    polytrope = f"compression and expansion by one polytrope, exponent {gas.polytropic_compression:g}"
    return " or ".join([mirrored] * gas.measured + [polytrope] * modelled)


def _misfiring(scene: Scene, cylinders: tuple[int, ...]) -> Scene:
    assert scene.engine is not None
    return scene.model_copy(update={"engine": scene.engine.model_copy(update={"misfire": cylinders})})
