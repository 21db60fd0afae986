"""Consistency of hardened fillets: one way of counting them, hardness, points, room for the case."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.hardening import NITRIDED_HV, CaseHardening, Fillet
from cranktopo.design.schema import Scene

_STEELS = ("Steel", "Forg_Steel", "CaseHard_Steel")


def check_hardening(scene: Scene) -> None:
    """Check the hardened fillets of a scene, or of one half of its throw."""
    settings = scene.fatigue
    if settings.hardening is None and settings.journal_hardening is None:
        return
    if settings.surface_treatment_factor != 1.0:
        raise CranktopoError(
            "fatigue: surface_treatment_factor and [fatigue.hardening] each give the strength of the "
            "same fillets.",
            hint="Keep one of them.",
        )
    if scene.material.fkm_group not in _STEELS:
        allowed = "hardness stands for strength in steel only, beside [fatigue.hardening]"
        raise scene.invalid("material.fkm_group", allowed, "Give surface_treatment_factor with its source.")
    for key, one, fillets in _tables(scene):
        _check_hardness(scene, key, one)
        _check_points(key, one)
        for fillet in fillets:
            _check_room(scene, key, one, fillet)


def _tables(scene: Scene) -> Iterator[tuple[str, CaseHardening, list[Fillet]]]:
    settings = scene.fatigue
    for name in ("hardening", "journal_hardening"):
        one = getattr(settings, name)
        if one is not None:
            yield f"fatigue.{name}", one, [at for at, own in settings.hardened.items() if own is one]


def _check_hardness(scene: Scene, key: str, one: CaseHardening) -> None:
    core = one.core_HV(scene.material.ultimate_MPa)
    if core is None:
        raise CranktopoError(
            f"{key}.core_hardness_HV: is missing, and material.ultimate_MPa gives none (255 to 2180 MPa "
            "have one in ISO 18265).",
            hint="Give the hardness of the core.",
        )
    least = core + NITRIDED_HV if one.process == "nitrided" else core
    surface = one.surface_hardness_HV
    if surface < core or (one.process == "nitrided" and surface <= least):
        how = f"more than {least:.4g}" if one.process == "nitrided" else f"at least {core:.4g}"
        why = ": the nitriding depth is where 50 HV above it are left" if one.process == "nitrided" else ""
        allowed = f"must be {how} HV, the core having {core:.4g} HV{why}"
        raise invalid(f"{key}.surface_hardness_HV", surface, allowed, "Correct it, or core_hardness_HV.")
    drop = one.transition_hardness_HV
    if drop is not None and (one.process != "induction" or drop > core):
        allowed = f"is that below an induction-hardened layer, at most the core's {core:.4g} HV"
        raise invalid(f"{key}.transition_hardness_HV", drop, allowed, "Leave it out, or correct it.")


def _check_points(key: str, one: CaseHardening) -> None:
    depths = [depth for depth, _ in one.residual_stress_MPa]
    if any(b <= a for a, b in pairwise(depths)):
        raise invalid(f"{key}.residual_stress_MPa", depths, "depths must increase from point to point")
    if depths and depths[0] != 0:
        raise invalid(
            f"{key}.residual_stress_MPa", depths, "the first point must lie at the surface, depth 0"
        )


def _check_room(scene: Scene, key: str, one: CaseHardening, fillet: Fillet) -> None:
    """Check that cases from both sides of the web, and of the wall of a bored journal, do not meet."""
    throw = scene.throw
    journal = throw.crankpin if fillet == "pin" else throw.main_journal
    wall = (journal.outer_diameter_mm - journal.bore_diameter_mm) / 2
    room = {"web": scene.web.thickness_mm / 2, f"wall of the {fillet}": wall / 2}
    where, most = min(room.items(), key=lambda item: item[1])
    if one.case_depth_mm > most:
        allowed = f"must be at most {most:.4g} mm, half of the {where}"
        raise invalid(f"{key}.case_depth_mm", one.case_depth_mm, allowed, "Correct the depth, or its unit.")
