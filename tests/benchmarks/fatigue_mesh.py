"""What the mesh of the fillets costs and gives: concentration factors, seconds and the rule's quality checks.

Run with `python -m tests.benchmarks.fatigue_mesh` (all throws and sizes) or with `--throw NAME --fraction F`
for one row. Throws inside the validity of IACS UR M53; factors from finite elements are followed by
their difference from the rule's polynomials in percent.
"""

from __future__ import annotations

import argparse
import subprocess
import sys

from cranktopo.tasks.throw_fatigue.m53 import concentration_factors, dimensions, outside_validity
from cranktopo.tasks.throw_fatigue.rule_fillets import element_factors
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target
from tests.studies.example_throws import rule_throws

FRACTIONS = (0.5, 0.35, 0.25, 0.17, 0.12)


def row(name: str, fraction: float) -> str:
    """One line of the table."""
    scene = rule_throws()[name]
    size = dimensions(scene)
    assert outside_validity(size) == ()
    model = solve_stresses(Target(name, scene), ("moment", "bending", "torsion"), fraction)
    quality, rule = model.quality, vars(concentration_factors(size))
    factors = [f"{v:.3f} ({100 * (v / rule[k] - 1):+.1f})" for k, v in vars(element_factors(model)).items()]
    checks = f"{quality.normal_percent:.1f} | {quality.jump_percent:.1f}"
    seconds = f"{quality.mesh_seconds:.1f} | {quality.solve_seconds:.1f}"
    return (
        f"| {name} | {fraction:g} | {quality.longest_edge:.2f} | {quality.nodes:,} | "
        f"{' | '.join(factors)} | {checks} | {seconds} |"
    )


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--throw", choices=[*rule_throws()])
    parser.add_argument("--fraction", type=float)
    chosen = parser.parse_args()
    if chosen.throw and chosen.fraction:
        print(row(chosen.throw, chosen.fraction), flush=True)
        return
    print("| throw | size/r | longest edge/r | nodes | alpha_B | alpha_T | beta_B | beta_Q | beta_T ", end="")
    print("| normal % | jump % | s, mesh | s, solve |")
    print("|---" * 13 + "|")
    for name in rule_throws():
        for fraction in FRACTIONS:
            command = [sys.executable, "-m", __spec__.name, "--throw", name, "--fraction", f"{fraction}"]
            print(
                subprocess.run(command, capture_output=True, text=True, check=True).stdout, end="", flush=True
            )


if __name__ == "__main__":
    main()
