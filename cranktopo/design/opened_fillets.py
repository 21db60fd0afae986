"""Fillets that the bore of the other journal opens: a rule has no factor for such an edge."""

from __future__ import annotations

from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.journal import Journal


def bore_remarks(scene: Scene) -> tuple[str, ...]:
    """Return in sentences which bore, that runs through the web, ends in the fillet of the other journal."""
    names = ("crankpin", "main journal"), ("main journal", "crankpin")
    found = (
        _remark(bored, other, half.throw.radius_mm, own_names)
        for half in halves(scene)
        for (bored, other), own_names in zip(_pairs(half), names, strict=True)
        if _opens(bored, other, half.throw.radius_mm)
    )
    return tuple(dict.fromkeys(found))


def opened_fillets(half: Scene) -> tuple[bool, bool]:
    """Tell of the fillets of main journal and crankpin whether a bore opens them, toward the other axis."""
    of_main, of_pin = (_opens(*pair, half.throw.radius_mm) for pair in _pairs(half))
    return of_main, of_pin


def _pairs(half: Scene) -> tuple[tuple[Journal, Journal], tuple[Journal, Journal]]:
    """Return a bored journal and the one with the fillet: for the fillet of the main journal, of the pin."""
    main, pin = half.throw.main_journal, half.throw.crankpin
    return (pin, main), (main, pin)


def _opens(bored: Journal, other: Journal, apart_mm: float) -> bool:
    near = apart_mm - bored.bore_radius_mm
    return bored.bore_diameter_mm > 0 and other.fillet_mm > 0 and near < other.clear_radius_mm


def _remark(bored: Journal, other: Journal, apart_mm: float, names: tuple[str, str]) -> str:
    return (
        f"the bore of the {names[0]} opens in the fillet of the {names[1]}, with sharp edges: it comes to "
        f"{apart_mm - bored.bore_radius_mm:.4g} mm from that journal's axis, and the fillet reaches to "
        f"{other.clear_radius_mm:.4g} mm"
    )
