"""`cranktopo plan`: which effects a scene calls for, and why."""

from __future__ import annotations

import json

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.options import DEFAULT_DESIGN


@click.command(name="plan")
@click.argument("design", default=DEFAULT_DESIGN, shell_complete=designs)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(design: str, as_json: bool) -> None:
    """The effects of a design: state, reason, what leaving each out changes, and what it costs.

    DESIGN is a TOML file or the name of a built-in design. Costs and estimates come from closed forms;
    nothing is solved.

    Example: cranktopo plan opposed-piston
    """
    from cranktopo.effects import plan
    from cranktopo.report.tables.plan_text import plan_text
    from cranktopo.scene import load_scene
    from cranktopo.scene.assumed import (
        ENVELOPE,
        LOADS,
        SUPPORTS,
        THROW,
        assumed_json,
        assumed_text,
        assumptions,
    )

    scene = load_scene(design)
    effects = plan(scene)
    assumed = assumptions(scene, (THROW, LOADS, SUPPORTS, ENVELOPE))
    if as_json:
        payload = {
            "schema_version": 1,
            "design": scene.name,
            "effects": effects.as_json(),
            "assumed": assumed_json(assumed),
        }
        click.echo(json.dumps(payload, indent=2))
    else:
        click.echo(f"{scene.name}, threshold {100 * scene.effects.threshold:g} %\n\n{plan_text(effects)}")
        if assumed:
            click.echo(assumed_text(assumed), err=True)
