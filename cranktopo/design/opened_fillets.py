"""Fillets that the bore of the other journal opens: a rule has no factor for such an edge."""

from __future__ import annotations

from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.journal import Journal


def bore_remarks(scene: Scene) -> tuple[str, ...]:
    """Return in sentences which bore, that runs through the web, ends in the fillet of the other journal."""
    found = (remark for half in halves(scene) for remark in _of_half(half))
    return tuple(dict.fromkeys(found))


def _of_half(half: Scene) -> tuple[str, ...]:
    main, pin, apart = half.throw.main_journal, half.throw.crankpin, half.throw.radius_mm
    pairs = ((pin, "crankpin", main, "main journal"), (main, "main journal", pin, "crankpin"))
    return tuple(filter(None, (_remark(*pair, apart) for pair in pairs)))


def _remark(bored: Journal, name: str, other: Journal, other_name: str, apart_mm: float) -> str:
    near = apart_mm - bored.bore_radius_mm
    if not bored.bore_diameter_mm or not other.fillet_mm or near >= other.clear_radius_mm:
        return ""
    return (
        f"the bore of the {name} opens in the fillet of the {other_name}, with sharp edges: it comes to "
        f"{near:.4g} mm from that journal's axis, and the fillet reaches to {other.clear_radius_mm:.4g} mm"
    )
