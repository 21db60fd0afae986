"""Outlets of oil bores in three throws: the rule's factors beside elements, and a second method beside both.

Run with `python -m tests.benchmarks.outlet_factors`.
"""

from __future__ import annotations

from cranktopo.tasks.throw_fatigue.m53_outlet import outlet_factors
from tests.studies.outlet_throws import OUTLETS, by_elements, without_bore

COARSE, FINE = 0.5, 0.25
"""Element size in the outlet over the radius of its rounding."""
_HEAD = (
    "throw, outlet",
    "load",
    "rule",
    "elements",
    "rule off by %",
    f"elements of {COARSE:g} r instead of {FINE:g} r, %",
    "stress there without the bore / nominal",
    "second method",
    "off by %",
)


def main() -> None:
    """Print the table as Markdown."""
    print(f"| {' | '.join(_HEAD)} |\n{'|---' * len(_HEAD)}|")
    for outlet in OUTLETS:
        pin = outlet.scene().throw.crankpin.outer_diameter_mm
        rule = outlet_factors(outlet.bore_mm, pin)
        coarse, fine = by_elements(outlet, COARSE), by_elements(outlet, FINE)
        local, second = without_bore(outlet)
        place = f"{outlet.throw}, {outlet.angle_deg:g} deg, d/D {outlet.bore_mm / pin:.3f}"
        for i, load in enumerate(("bending", "torsion")):
            off = [100 * (v / fine[i] - 1) for v in (rule[i], coarse[i], second[i])]
            print(
                f"| {place} | {load} | {rule[i]:.2f} | {fine[i]:.2f} | {off[0]:+.0f} | {off[1]:+.1f} | "
                f"{local[i]:.2f} | {second[i]:.2f} | {off[2]:+.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
