"""`cranktopo fatigue`: comparative fatigue safety of throws with true fillets."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import click

from cranktopo.cli.completion import designs
from cranktopo.cli.options import DEFAULT_DESIGN, FATIGUE_METHODS
from cranktopo.cli.parameters import Choice, Number
from cranktopo.cli.verbosity import say, verbosity_options
from cranktopo.errors import CranktopoError, ExitCode

if TYPE_CHECKING:
    from cranktopo.evaluate.safety_field import FatigueField
    from cranktopo.evaluate.targets import Target
    from cranktopo.loads.histories import HistoryKind


@click.command()
@click.argument("targets", metavar="TARGET...", nargs=-1, shell_complete=designs)
@click.option(
    "--method",
    type=Choice(FATIGUE_METHODS),
    default="lsa",
    show_default=True,
    help="Local stress analysis, FKM guideline, or the rule IACS UR M53.",
)
@click.option(
    "--loads",
    type=Choice(["extremes", "cycle"]),
    default="extremes",
    show_default=True,
    help="Extremes of radial force and torque joined (bounds the cycle), or every angle of the cycle.",
)
@click.option("--baseline", metavar="TARGET", help="The target that the others are compared with.")
@click.option(
    "--fillet-fraction",
    type=Number("--fillet-fraction", 0.0, 0.5),
    help="Element size in a fillet over its radius; by default 0.17: no edge above a quarter.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for fatigue.json, and VTU and picture of each target; a run shows it.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@verbosity_options
def command(
    targets: tuple[str, ...],
    method: str,
    loads: str,
    baseline: str | None,
    fillet_fraction: float | None,
    out: Path | None,
    as_json: bool,
) -> None:
    """Fatigue safety of each TARGET (a design whose fillets have a radius) on curved tet10 elements.

    The unit loads are solved once; every load state is a sum of them. The safety is that of the worst point
    of the fillets, anywhere on the throw.

    Example: cranktopo fatigue mikron-iiic-hollow --baseline mikron-iiic --out fatigue
    """
    from cranktopo.evaluate.safety_field import check_inputs
    from cranktopo.evaluate.stress_model import RULE_FRACTION
    from cranktopo.evaluate.targets import resolve_targets
    from cranktopo.loads.histories import HistoryKind

    names = targets or (baseline or DEFAULT_DESIGN,)
    if baseline is not None and baseline not in names:
        names = (baseline, *names)
    if out is not None and method == "m53":
        raise CranktopoError(
            "--out: method 'm53' gives two numbers per throw and no field.",
            hint="Leave --out, or take lsa or fkm.",
            code=ExitCode.USAGE,
        )
    if out is not None:
        from cranktopo.store import check_folder

        check_folder(out)
    kind: HistoryKind = next(name for name in get_args(HistoryKind) if name == loads)
    resolved = resolve_targets(names, fillets=True)
    for target in resolved:
        check_inputs(target, method, kind)
    index = None if baseline is None else names.index(baseline)
    fraction = RULE_FRACTION if fillet_fraction is None else fillet_fraction
    if method == "m53":
        _rule(resolved, kind, fraction, index, as_json)
    else:
        _field(resolved, method, kind, fraction, index, as_json, out)


def _rule(
    targets: list[Target], kind: HistoryKind, fraction: float, baseline: int | None, as_json: bool
) -> None:
    from cranktopo.evaluate.rule_check import check_rule
    from cranktopo.report import fatigue_tables as report
    from cranktopo.report.tables import terminal

    checks = [check_rule(target, kind, fraction, say) for target in targets]
    if as_json:
        click.echo(json.dumps(report.checks_json(checks, kind, baseline), indent=2))
        return
    click.echo(terminal(report.rule_table(checks, baseline)))
    click.echo("\n" + terminal(report.factor_table(checks)))
    for check in checks:
        if check.outside:
            click.echo(f"{check.name}: outside the rule's polynomials: {'; '.join(check.outside)}.")
    _verdicts(report.verdicts(checks, baseline) if baseline is not None else [])


def _field(
    targets: list[Target],
    method: str,
    kind: HistoryKind,
    fraction: float,
    baseline: int | None,
    as_json: bool,
    out: Path | None,
) -> None:
    from cranktopo.evaluate.safety_field import FieldMethod, assess
    from cranktopo.report import fatigue_tables as report
    from cranktopo.report.tables import terminal
    from cranktopo.store import write_json

    chosen: FieldMethod = next(name for name in get_args(FieldMethod) if name == method)
    fields = []
    for target in targets:
        field = assess(target, chosen, kind, fraction, say)
        fields.append(field)
        _warn(field)
        if out is not None:
            _write(out, field)
    result = report.fields_json(fields, kind, baseline)
    if out is not None:
        write_json(out / "fatigue.json", result)
    if as_json:
        click.echo(json.dumps(result, indent=2))
        return
    click.echo(terminal(report.field_table(fields, baseline)))
    _verdicts(report.verdicts(fields, baseline) if baseline is not None else [])


def _verdicts(lines: list[str]) -> None:
    if lines:
        click.echo("\n" + "\n".join(lines))


def _warn(field: FatigueField) -> None:
    quality = field.model.quality
    if not quality.within_rule:
        say(f"note: {field.model.name}: {quality.shortfall}; a smaller --fillet-fraction helps.")
    if field.elsewhere.safety < field.critical.safety:
        say(
            f"note: {field.model.name}: {field.elsewhere.safety:.3f} off the fillets at "
            f"{field.elsewhere.place}; sharp edges there make it depend on the mesh."
        )


def _write(out: Path, field: FatigueField) -> None:
    from cranktopo.report.fatigue_files import save_fatigue_picture, write_fatigue_vtu

    out.mkdir(parents=True, exist_ok=True)
    for suffix, write in ((".vtu", write_fatigue_vtu), (".png", save_fatigue_picture)):
        path = out / f"fatigue-{field.method}-{field.model.name}{suffix}"
        write(path, field)
        say(str(path))
