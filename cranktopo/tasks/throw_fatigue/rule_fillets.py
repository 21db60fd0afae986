"""Factors of the fillets by elements, and both fillets against the crankshaft rule with a set of factors."""

from __future__ import annotations

from cranktopo.design.schema import Scene
from cranktopo.engine.throw_compliance import web_lever_mm
from cranktopo.numerics.tetrahedra.stress import principal_stresses, von_mises
from cranktopo.tasks.throw_fatigue.hardened_layer import layers
from cranktopo.tasks.throw_fatigue.m53 import (
    ConcentrationFactors,
    Dimensions,
    FilletCheck,
    Nominal,
    dimensions,
    fatigue_strength_MPa,
    journal_equivalent_MPa,
    nominal_stresses,
    pin_equivalent_MPa,
)
from cranktopo.tasks.throw_fatigue.m53_hardening import journal_stresses, pin_stresses, treated_check
from cranktopo.tasks.throw_fatigue.stress_model import StressModel


def element_factors(model: StressModel) -> ConcentrationFactors:
    """Concentration factors from unit stresses, as Appendix III of the rule defines them.

    Bending: largest von Mises stress in a fillet under a pure moment; torsion: half the largest difference of
    principal stresses; shear: what three-point bending adds to the journal fillet over its moment.

    Args:
        model: with the fields "moment", "bending" and "torsion"; of a whole throw the first web counts.
    """
    size = dimensions(model.scene)
    moment, radial, twist = (
        model.stress.stress_MPa[model.kinds.index(kind)] for kind in ("moment", "bending", "torsion")
    )
    lever = web_lever_mm(model.scene)
    pure, three = nominal_stresses(size, 1.0, 0.0, 1.0), nominal_stresses(size, lever / 2, 0.5, 0.0)
    principal = principal_stresses(twist)
    shear = (principal[:, 0] - principal[:, 2]) / 2
    pin, journal = (on & ~model.on_second for on in (model.on_pin, model.on_journal))
    beta = float(von_mises(moment[journal]).max() / pure.bending_MPa)
    remainder = float(von_mises(radial[journal]).max()) - beta * three.bending_MPa
    return ConcentrationFactors(
        alpha_bending=float(von_mises(moment[pin]).max() / pure.bending_MPa),
        alpha_torsion=float(shear[pin].max() / pure.pin_torsion_MPa),
        beta_bending=beta,
        beta_shear=remainder / three.shear_MPa,
        beta_torsion=float(shear[journal].max() / pure.journal_torsion_MPa),
    )


def fillet_checks(
    scene: Scene, size: Dimensions, factors: ConcentrationFactors, nominal: Nominal
) -> dict[str, FilletCheck]:
    """Return both fillets against the rule with a set of factors; it needs a tensile strength."""
    settings, ultimate = scene.fatigue, scene.material.ultimate_MPa or 0.0
    process = settings.process_factor * settings.surface_treatment_factor
    added = settings.additional_stress_MPa
    plain = {
        "pin": FilletCheck(
            pin_equivalent_MPa(factors, nominal, added),
            fatigue_strength_MPa(size.pin, size.pin_fillet, ultimate, process),
        ),
        "journal": FilletCheck(
            journal_equivalent_MPa(factors, nominal, added),
            fatigue_strength_MPa(size.journal, size.journal_fillet, ultimate, process),
        ),
    }
    treated = layers(scene)
    loads = {"pin": pin_stresses, "journal": journal_stresses}
    return plain | {
        fillet: treated_check(plain[fillet], layer, loads[fillet](size, factors, nominal), added)
        for fillet, layer in treated.items()
    }
