"""The re-model of a run as text and page: what was tried, shape error, stiffness, what is not represented."""

from __future__ import annotations

from collections.abc import Mapping

from cranktopo.base.units import plain_number, stem_and_unit
from cranktopo.report.page import Fact, FactStatus, Page, Section, pairs, versions_section, with_unit
from cranktopo.report.result_table import Column, ResultTable, labelled, tabulate, terminal
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, gallery_picture
from cranktopo.tasks.extraction.text import release_text, release_verdict
from cranktopo.tasks.refit.result import (
    RefitResult,
    RefitStiffness,
    RefitThrow,
    RefitThrows,
    UnrepresentedRegion,
)
from cranktopo.tasks.refit.select import FitTrial
from cranktopo.tasks.throw_fea.quantities import (
    MASS,
    NOTICEABLE_PERCENT,
    estimate_line,
    percent_change,
    worse_line,
)

_FILES = ("report", "design", "step", "stl", "drawing", "drawing_svg", "json")
_TRIALS: tuple[Column[FitTrial], ...] = (
    Column("tried", 0, lambda trial: trial.step),
    Column("parameters", 0, lambda trial: float(trial.parameters)),
    Column("overlap_percent", 2, lambda trial: trial.iou_percent),
    Column("gain_percent", 2, lambda trial: trial.gain_percent),
    Column("kept", 0, lambda trial: "yes" if trial.kept else "no"),
)
_REST: tuple[Column[UnrepresentedRegion], ...] = (
    Column("what", 0, lambda item: _kind(item)),
    Column("volume_mm3", 0, lambda item: item.volume_mm3),
    Column("of_the_web_percent", 1, lambda item: item.share_percent),
    Column("centre_mm", 0, lambda item: _centre(item)),
    Column("extent_mm", 0, lambda item: _extent(item)),
)


def refit_text(data: RefitResult) -> str:
    """Return the content of remodel.json for a terminal."""
    rows = [*_shape_rows(data), *_stiffness_rows(data.stiffness)]
    lines = [
        *_worse(data),
        terminal(tabulate(_TRIALS, data.trials)),
        *_fit_lines(data),
        "",
        labelled(rows),
        *_estimate(data.stiffness),
        *_rest(data),
    ]
    names = data.files.as_json()
    return "\n".join([*lines, "", *(f"{data.folder}/{names[kind]}" for kind in _FILES)])


def _shape_rows(data: RefitResult) -> list[tuple[str, str]]:
    """Return the distance of the web from the body: overlap, distance, mass."""
    iou, distance, mass = data.iou, data.distance_mm, data.web_mass_kg
    place = ", ".join(f"{value:.1f}" for value in distance.max_at)
    half, web = 100 * iou.half_throw, 100 * iou.web
    return [
        ("overlap (IoU)", f"half throw {half:.1f} %, web alone {web:.1f} %"),
        ("surface distance", f"mean {distance.mean:.2f} mm, largest {distance.max:.2f} mm at ({place}) mm"),
        (
            "mass of the web",
            f"{mass.fitted:.3f} kg, body {mass.body:.3f} kg ({mass.difference_percent:+z.1f} %)",
        ),
        *_throw_rows(data.throws),
        *_release_rows(data),
    ]


def _throw_rows(throws: RefitThrows | None) -> list[tuple[str, str]]:
    """Return mass and balance of the throw, of its body and of the original, each with its counterweights."""
    if throws is None:
        return []
    named = {"body ": throws.body, **({"original ": throws.original} if throws.original else {})}
    all_of = {"": throws.fitted, **named}
    mass = [f"{name}{throw.mass_kg:.3f} kg" for name, throw in all_of.items()]
    if throws.original:
        mass[-1] += f" ({_heavier_percent(throws.fitted, throws.original):+z.1f} %)"
    pull = [f"{name}{plain_number(throw.unbalance_kg_mm)} kg mm" for name, throw in all_of.items()]
    rows = [("mass of the throw", ", ".join(mass)), ("unbalance", ", ".join(pull))]
    factors = [(name, throw.balance_factor_percent) for name, throw in all_of.items()]
    told = [f"{name}{plain_number(factor, 3)} %" for name, factor in factors if factor is not None]
    return [*rows, *([("balance factor", ", ".join(told))] if told else [])]


def _heavier_percent(throw: RefitThrow, original: RefitThrow) -> float:
    return percent_change(throw.mass_kg, original.mass_kg)


def _worse(data: RefitResult) -> list[str]:
    """Return what is worse than the original web by mass and balance, and a note beside it."""
    moved = data.throws.moved if data.throws is not None and data.throws.original is not None else None
    found = [*_worse_words(data), *([f"note: {moved.told}"] if moved else [])]
    return [*found, ""] if found else []


def _worse_words(data: RefitResult) -> list[str]:
    throws = data.throws
    if throws is None or throws.original is None:
        return []
    moved = [f"worse than the original web: {throws.moved.words}"] if throws.moved else []
    heavier = worse_line({MASS: _heavier_percent(throws.fitted, throws.original)}, "the original web")
    return [*moved, *([heavier] if heavier else [])]


def _release_rows(data: RefitResult) -> list[tuple[str, str]]:
    """Return whether the process makes the web; runs of an earlier version were not looked at."""
    found = data.undercuts
    return [("die releases it", f"{release_verdict(found)}, {release_text(found)}")] if found else []


def _stiffness_rows(stiffness: RefitStiffness | None) -> list[tuple[str, str]]:
    """Return the stiffnesses of the web without fillets beside those of the body, and with fillets."""
    if stiffness is None:
        return []
    evaluated = (stiffness.fitted_without_fillets, stiffness.body, stiffness.fitted)
    torsion, bending = [e.torsion_Nm_per_rad for e in evaluated], [e.bending_N_per_mm for e in evaluated]
    rows = []
    for kind, unit, values in (("torsion", "kN m/rad", torsion), ("bending", "kN/mm", bending)):
        bare, body, whole = (value / 1000 for value in values)
        difference = stiffness.difference_percent[kind]
        text = f"{bare:.1f} without fillets, body {body:.1f} ({difference:+z.1f} %); with fillets {whole:.1f}"
        rows.append((f"{kind}, {unit}", text))
    return rows


def _estimate(stiffness: RefitStiffness | None) -> list[str]:
    if stiffness is None:
        return []
    evaluated = (stiffness.body, stiffness.fitted_without_fillets, stiffness.fitted)
    found = [entry.error_estimate_percent for entry in evaluated]
    return [estimate_line(*([errors[kind] for errors in found] for kind in ("torsion", "bending")))]


def _rest(data: RefitResult) -> list[str]:
    if not data.not_represented:
        return ["the parametric web represents the whole body to within two cells of its surface"]
    lines = [
        "not represented by the parametric web (mm; x across, y along the throw from the crank axis, "
        "z along the crank from the middle of the journal):"
    ]
    for item in data.not_represented:
        size = f"{item.volume_mm3:.0f} mm3 = {item.share_percent:.1f} % of the web"
        lines.append(f"  {_kind(item)} of {size} around {_centre(item)}: {_extent(item)}")
    return lines


def _centre(item: UnrepresentedRegion) -> str:
    x, y, z = item.centre_mm
    return f"(±{x:.1f}, {y:.1f}, {z:.1f})" if item.pair else f"(0, {y:.1f}, {z:.1f})"


def _extent(item: UnrepresentedRegion) -> str:
    return ", ".join(
        f"{axis} {low:.0f} to {high:.0f}"
        for axis, low, high in zip(("|x|", "y", "z"), item.low_mm, item.high_mm, strict=True)
    )


def _kind(item: UnrepresentedRegion) -> str:
    if item.kind == "recess":
        return f"recess in the {item.face} face" if item.face else "recess in the side"
    return {"window": "window", "hollow": "hollow", "material": "missing material"}[item.kind]


def _fit_lines(data: RefitResult) -> list[str]:
    """Say why so many stations, and what the final fit reached from each initial guess."""
    tried = [trial for trial in data.trials if trial.step.endswith("stations")]
    kept = [trial.step for trial in tried if trial.kept]
    least = data.rules.least_gain_percent
    lines = [
        f"{step}: the fewest within {least:g} points of the most that any number tried reaches "
        f"({max(trial.iou_percent for trial in tried):.2f} %)"
        for step in kept
    ]
    starts = ", ".join(f"{100 * overlap:.2f}" for overlap in data.overlap_by_start)
    return [
        *lines,
        f"final fit on finer cells, from {len(data.overlap_by_start)} initial guesses: {starts} %",
    ]


_KINDS = {"torsion": "Torsional stiffness", "bending": "Bending stiffness"}


def refit_page(
    data: RefitResult, bodies: tuple[ShownBody, ...], versions: Mapping[str, str | None], written: str
) -> Page:
    """Return the report of a re-model: the fitted half throw, and the body that it was fitted to."""
    overlap = f"{100 * data.iou.web:.1f}"
    return Page(
        title=f"Re-modelled web {data.design}",
        subtitle=f"Fitted to the body of run {data.run}, {written}",
        headline=" ".join([*_headline(data), f"The parametric web overlaps the body by {overlap} % (IoU)."]),
        facts=_facts(data),
        sections=(refit_section(data), _limits(data), versions_section(versions, data.files.as_json())),
        scene3d=Scene3D(bodies),
        picture=gallery_picture(bodies),
    )


def _headline(data: RefitResult) -> list[str]:
    """Return what is worse than the original web, in sentences."""
    return [f"{line[0].upper()}{line[1:]}." for line in _worse_words(data)]


def refit_section(data: RefitResult) -> Section:
    """Return the shape error, stiffnesses, what was tried and what is left over."""
    tables: list[tuple[str, ResultTable]] = [
        ("Web against body", pairs([*_shape_rows(data), *_stiffness_rows(data.stiffness)])),
        ("Features tried, each kept only for what it gains", tabulate(_TRIALS, data.trials)),
    ]
    if data.not_represented:
        tables.append(("Not represented by the parametric web", tabulate(_REST, data.not_represented)))
    text = (
        "The body has no fillets, so the web is compared without its own. "
        + " ".join(f"{line[0].upper()}{line[1:]}." for line in _fit_lines(data))
        + " Places: x across, y along the throw from the crank axis, z along the crank from the middle of "
        "the main journal."
    )
    return Section("remodel", "Re-modelled web", text, tuple(tables))


def _facts(data: RefitResult) -> tuple[Fact, ...]:
    mass, stiffness = data.web_mass_kg, data.stiffness
    facts = [
        Fact(
            "Mass of the web",
            f"{mass.fitted:.3f} kg",
            f"{mass.difference_percent:+z.1f} % against the body",
            "neutral",
        )
    ]
    facts += _throw_facts(data.throws)
    changes = {} if stiffness is None else stiffness.difference_percent
    for kind, label in _KINDS.items() if changes else ():
        change = f"{changes[kind]:+z.1f} %"
        facts.append(Fact(label, change, "without fillets, against the body", "neutral"))
    distance = data.distance_mm
    note = f"{distance.mean:.2f} mm on average"
    return (*facts, Fact("Largest distance to the body", f"{distance.max:.1f} mm", note, "neutral"))


def _throw_facts(throws: RefitThrows | None) -> list[Fact]:
    """Return the mass of the throw, and where the balance factor went if no limit holds it there."""
    if throws is None or throws.original is None:
        return []
    change = _heavier_percent(throws.fitted, throws.original)
    note = f"{change:+z.1f} % against the original's {throws.original.mass_kg:.3f} kg"
    status: FactStatus = "neutral" if abs(change) < NOTICEABLE_PERCENT else "bad" if change > 0 else "good"
    facts = [Fact("Mass of the throw", f"{throws.fitted.mass_kg:.3f} kg", note, status)]
    moved = throws.moved
    if moved is not None:
        value = f"{moved.original_percent:z.0f} -> {moved.balance_factor_percent:z.0f} %"
        facts.append(Fact("Balance factor", value, moved.told, "bad"))
    return facts


def _limits(data: RefitResult) -> Section:
    rows = [
        (stem_and_unit(name)[0].replace("_", " "), with_unit(name, value))
        for name, value in vars(data.rules).items()
    ]
    return Section("limits", "Limits of the fit", tables=(("As it was asked for", pairs(rows)),))
