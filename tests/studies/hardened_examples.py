"""Nitrided fillets of the Mikron by a printed range of depth and hardness, in Markdown.

    python -m tests.studies.hardened_examples

Gas nitriding of 31CrMoV9, the Mikron's steel, from 510 to 590 deg C and over four times: hardness 602 to 787
HV, depth 0.27 to 0.70 mm (N. Syla, F. Aliaj, M. Rama, Acta Physica Polonica A 132, 2017, 484, doi
10.12693/APhysPolA.132.484). Which depth goes with which hardness is not in the abstract, which was at hand:
all corners of the range are judged.
"""

from __future__ import annotations

from cranktopo.design.hardening import Hardening
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fea.targets import Target
from tests.validation.table import lines_of

SOURCE = "N. Syla et al., Acta Phys. Pol. A 132 (2017) 484"
DEPTHS_MM, HARDNESSES_HV = (0.27, 0.70), (602.0, 787.0)
FILLET_FRACTION = 0.45
HEAD = (
    "depth mm",
    "hardness HV",
    *(f"{fillet} fillet{what}" for fillet in ("pin", "journal") for what in ("", ": decided", ": gain")),
)


def nitrided(depth_mm: float, surface_HV: float) -> Scene:
    """The Mikron with both fillets nitrided."""
    scene = load_scene("mikron-iiic")
    table = Hardening(
        process="nitrided", case_depth_mm=depth_mm, surface_hardness_HV=surface_HV, source=SOURCE
    )
    return scene.model_copy(
        update={"fatigue": scene.fatigue.model_copy(update={"hardening": table, "journal_hardening": None})}
    )


def judged(depth_mm: float, surface_HV: float) -> FatigueField:
    target = Target("mikron-nitrided", nitrided(depth_mm, surface_HV))
    return fatigue_field(target, "lsa", fillet_fraction=FILLET_FRACTION)


def row(depth_mm: float, surface_HV: float) -> list[str]:
    found = judged(depth_mm, surface_HV).hardening
    cells = [
        cell
        for one in (found["pin"], found["journal"])
        for cell in (f"{one.safety:.3f}", f"{one.depth_mm:.2f} mm", f"{one.gain:.2f}")
    ]
    return [f"{depth_mm:.2f}", f"{surface_HV:g}", *cells]


if __name__ == "__main__":
    print(lines_of(HEAD, [row(depth, hv) for depth in DEPTHS_MM for hv in HARDNESSES_HV]))
