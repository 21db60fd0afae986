"""What a lighter web really saves once the counterweight follows: mass of the shaft at equal unbalance.

    python -m tests.benchmarks.equal_unbalance [DESIGN...]

For each built-in design with counterweights, against the original:

- `web alone`: least mass, the counterweight stays as it is;
- `counterweight follows`: that web, with the half-angle at which the throw has its old unbalance again;
- `together`: least mass of web and counterweight at no more than the old unbalance, one search over both.

Torsion, bending and fatigue safety are kept in every search; `counterweight follows` is evaluated, not
searched. The mass of the shaft is that of all its throws. One line per web as Markdown.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

from scipy.optimize import brentq

from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.design.shape import ShapeTable
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.web_shape.evaluated_web import evaluated_web
from cranktopo.tasks.web_shape.run import shape_design
from cranktopo.throw.counterweight.table import LEAST_HALF_ANGLE_DEG

DESIGNS = ("car-diesel", "industrial-gas")
KEPT = ("torsion", "bending", "fatigue_safety")
HEAD = ("design", "web", "counterweight mm, deg", "throw kg", "shaft kg", "shaft %", "unbalance kg mm")


def with_half_angle(scene: Scene, angle_deg: float) -> Scene:
    """The scene with another half-angle of its counterweight."""
    assert scene.web.counterweight is not None
    weight = scene.web.counterweight.model_copy(update={"half_angle_deg": angle_deg})
    return scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": weight})})


def followed(scene: Scene, unbalance_kg_mm: float) -> Scene:
    """The scene with the half-angle at which its throw has an unbalance, or the nearest that there is."""

    def too_much(angle_deg: float) -> float:
        return throw_balance(with_half_angle(scene, angle_deg)).throw_unbalance_kg_mm - unbalance_kg_mm

    least, most = LEAST_HALF_ANGLE_DEG, 90.0
    if too_much(least) <= 0 or too_much(most) >= 0:
        return with_half_angle(scene, least if too_much(least) <= 0 else most)
    return with_half_angle(scene, float(brentq(too_much, least, most, xtol=1e-9)))


def row(name: str, web: str, scene: Scene, values: dict[str, float], before: dict[str, float]) -> str:
    """One web as a line of the table."""
    weight, engine = scene.web.counterweight, scene.engine
    assert weight is not None
    assert engine is not None
    cells = [
        name,
        web,
        f"{weight.outer_radius_mm:.2f}, {weight.half_angle_deg:.2f}",
        f"{values['mass']:.4f}",
        f"{engine.throws * values['mass']:.3f}",
        f"{100 * (values['mass'] / before['mass'] - 1):+.2f}",
        f"{values['unbalance']:.2f}",
        *(f"{100 * (values[key] / before[key] - 1):+.2f}" for key in KEPT),
    ]
    return f"| {' | '.join(cells)} |"


def shaped(scene: Scene, limits: tuple[str, ...], folder: Path) -> tuple[Scene, dict[str, Any]]:
    """The web of least mass and what its run tells."""
    goal = with_goal(scene, minimise="mass", maximise=None, limits=limits)
    data = shape_design(goal, out=folder).result.as_json()
    return load_scene(str(folder / "web.toml")), data["values"]


def lines(name: str) -> list[str]:
    """The webs of one design."""
    scene = load_scene(name)
    fixed = scene.model_copy(update={"shape": ShapeTable()})
    with tempfile.TemporaryDirectory() as folder:
        alone, found = shaped(fixed, ("unbalance none",), Path(folder) / "alone")
        before = found["original"]
        follows = followed(alone, before["unbalance"])
        judged = evaluated_web(
            follows, {"fatigue_safety"}, None, "counterweight follows", StageMemory()
        ).values
        together, both = shaped(scene, (), Path(folder) / "together")
    return [
        row(name, "original", scene, before, before),
        row(name, "web alone", alone, found["result"], before),
        row(name, "counterweight follows", follows, judged, before),
        row(name, "together", together, both["result"], before),
    ]


def main() -> None:
    """Print the table as Markdown."""
    head = (*HEAD, *(f"{key.replace('_', ' ')} %" for key in KEPT))
    print(f"| {' | '.join(head)} |\n|{'---|' * len(head)}", flush=True)
    for name in sys.argv[1:] or DESIGNS:
        print("\n".join(lines(name)), flush=True)


if __name__ == "__main__":
    main()
