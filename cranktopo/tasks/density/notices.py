"""Notices of what an optimisation does that its user may not expect, in one sentence each."""

from __future__ import annotations

from pathlib import Path

from cranktopo.bodies.cells.domain import Domain
from cranktopo.bodies.envelope_file import symmetrised
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.length_scale import length_notice
from cranktopo.tasks.density.manufacturing import unreachable_share

_WORTH_SAYING = 1e-3
"""Share of the design space below which a lost part of it is left unsaid."""


def notices(scene: Scene, domain: Domain) -> tuple[str, ...]:
    """Return sentences about the envelope, the die, the filter and the web that gains are measured against.

    Args:
        scene: as it is simulated, without what the plan leaves out.
        domain: its cells.
    """
    found = (_sides(scene), _die(scene, domain), length_notice(scene, domain), baseline_notice(scene))
    return tuple(sentence for sentence in found if sentence)


def _sides(scene: Scene) -> str:
    envelope = scene.envelope
    if envelope is None or envelope.shape != "stl" or not envelope.symmetric:
        return ""
    return symmetrised(Path(envelope.file))


def _die(scene: Scene, domain: Domain) -> str:
    if scene.effects.manufacturing_constraint != "on":
        return ""
    share = unreachable_share(scene, domain)
    if share < _WORTH_SAYING:
        return ""
    return (
        f"{scene.optimise.process}: {100 * share:.1f} % of the envelope's volume is left out, because voids "
        "of the envelope lie between it and the parting plane x = 0 (only holes right through along the "
        "crank axis are drilled afterwards)"
    )


def baseline_notice(scene: Scene) -> str:
    """Say what "original" means where it is a body from CAD, or the envelope is one; else empty."""
    if scene.original is not None:
        return f"the original web is that of the body in '{Path(scene.original.file).name}' ([original])"
    if scene.envelope is None or scene.envelope.shape != "stl":
        return ""
    return (
        "the original web is that of [web] in the design, not the body in "
        f"'{Path(scene.envelope.file).name}', which is the envelope only; [original] file = ... names a body"
    )
