"""Materials that the crankshaft rule IACS UR M53 covers, and its factor K beside the way they are made.

Source: UR M53, section 1.2 (forged or cast steel) and section 6 (K).
"""

from __future__ import annotations

from cranktopo.design.schema import Scene

_NO_STEEL = {
    "GJS": "nodular cast iron",
    "GJM": "malleable cast iron",
    "GJL": "grey cast iron",
    "Al_wrought": "wrought aluminium",
    "Al_cast": "cast aluminium",
}
"""Groups of the FKM guideline (`material.fkm_group`) that are no steel."""
_STEEL_GPa = 185.0, 230.0
"""Young's modulus of steels, 190 to 220 GPa, with room for measured values; nodular iron has up to 180."""
_CAST = 0.93
"""K of cast steel with cold rolling of the fillets."""


def uncovered_material(scene: Scene) -> str:
    """Return why the rule does not cover the material; empty for steel, as far as the design tells."""
    material = scene.material
    what = _NO_STEEL.get(material.fkm_group, "")
    if not what and not _STEEL_GPa[0] <= material.E_GPa <= _STEEL_GPa[1]:
        what = f"no steel by its Young's modulus of {material.E_GPa:g} GPa"
    return f"{material.name} is {what}; UR M53, 1.2, applies to forged or cast steel" if what else ""


def process_remark(scene: Scene) -> str:
    """Return that a cast crank has the factor K of a forged one; empty else."""
    factor, by_group = scene.fatigue.process_factor, scene.material.fkm_group == "GS"
    if factor <= _CAST or not (by_group or scene.optimise.process == "cast"):
        return ""
    cast = f"{scene.material.name} is cast steel" if by_group else "optimise.process = 'cast'"
    return (
        f"fatigue.process_factor = {factor:g} is K of a forging, but {cast}: UR M53 has {_CAST:g} for cast "
        "steel, and only with cold rolling of the fillets that the society approved"
    )
