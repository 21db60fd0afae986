"""Fillets that the bore of the other journal opens: a rule has no factor for such an edge."""

from __future__ import annotations

from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.journal import Journal


def bore_remarks(scene: Scene) -> tuple[str, ...]:
    """Return in sentences which bore, that runs through the web, ends in the fillet of the other journal."""
    found = (remark for half in halves(scene) for remark in _of_half(half))
    return tuple(dict.fromkeys(found))


def opened_fillets(half: Scene) -> tuple[bool, bool]:
    """Tell of the fillets of main journal and crankpin whether a bore opens them, toward the other axis."""
    main, pin, apart = half.throw.main_journal, half.throw.crankpin, half.throw.radius_mm
    return _opens(pin, main, apart), _opens(main, pin, apart)


def _opens(bored: Journal, other: Journal, apart_mm: float) -> bool:
    near = apart_mm - bored.bore_radius_mm
    return bored.bore_diameter_mm > 0 and other.fillet_mm > 0 and near < other.clear_radius_mm


def _of_half(half: Scene) -> tuple[str, ...]:
    main, pin, apart = half.throw.main_journal, half.throw.crankpin, half.throw.radius_mm
    pairs = ((pin, "crankpin", main, "main journal"), (main, "main journal", pin, "crankpin"))
    opened = opened_fillets(half)
    return tuple(_remark(*pair, apart) for pair, is_open in zip(pairs, opened, strict=True) if is_open)


def _remark(bored: Journal, name: str, other: Journal, other_name: str, apart_mm: float) -> str:
    near = apart_mm - bored.bore_radius_mm
    return (
        f"the bore of the {name} opens in the fillet of the {other_name}, with sharp edges: it comes to "
        f"{near:.4g} mm from that journal's axis, and the fillet reaches to {other.clear_radius_mm:.4g} mm"
    )
