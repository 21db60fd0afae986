"""The report of a loop as content: the best step, every step beside the original, the webs to turn."""

from __future__ import annotations

from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.base.files import write_bytes
from cranktopo.base.units import change_text
from cranktopo.report.page import (
    Fact,
    FactStatus,
    Page,
    Section,
    assumed_tables,
    counted,
    left_off_first,
    origin_rows,
    pairs,
    versions_section,
)
from cranktopo.report.plot import Picture, png
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, gallery_picture
from cranktopo.runs.kind import SHAPE
from cranktopo.runs.manifest import Manifest
from cranktopo.tasks.bound.text import bound_sections
from cranktopo.tasks.iterate.result import LoopResult, StepRow
from cranktopo.tasks.iterate.text import best_line, shape_lines, steps_estimate, steps_tables
from cranktopo.tasks.throw_fea.quantities import (
    BENDING,
    BENDING_PER_MASS,
    MASS,
    TORSION,
    TORSION_PER_MASS,
    Quantity,
    comparison_sentence,
    quantity_text,
)

_LINES = (
    (MASS, "s-", "0.45"),
    (TORSION, "o-", "#d1632a"),
    (BENDING, "^-", "#1f6fb4"),
    (TORSION_PER_MASS, "o--", "#d1632a"),
    (BENDING_PER_MASS, "^--", "#1f6fb4"),
)


def iterate_page(loop: LoopResult, manifest: Manifest, bodies: tuple[ShownBody, ...]) -> Page:
    """Return the report of a loop, finished or after any of its steps, with the half throw of every step."""
    return Page(
        title=f"Loop over the crank web of {loop.design}",
        subtitle=f"Loop {manifest.run}, {manifest.started[:10]}",
        headline=left_off_first(
            loop.shape.left_off if loop.shape else None, _less_safe(loop) + _headline(loop)
        ),
        facts=(*_facts(loop), _ended(loop)),
        sections=(
            _steps(loop),
            *bound_sections(loop.bound, "the body-fitted evaluation"),
            _provenance(loop, manifest),
            versions_section(manifest.versions),
        ),
        scene3d=Scene3D(bodies, first=_result_step(loop)),
        picture=gallery_picture(bodies),
    )


def _less_safe(loop: LoopResult) -> str:
    """Return what the web of the shape optimisation loses in its shaft, as a sentence; empty if nothing."""
    words = loop.shape.less_safe if loop.shape else None
    return f"Web of the shape optimisation: {words}. " if words else ""


def _headline(loop: LoopResult) -> str:
    """Tell which step is best, and all that it changes; what got worse is said first."""
    best = loop.best
    if best is None:
        line = best_line(loop)
        return f"{line[0].upper()}{line[1:]}."
    share = best.percent_of_original
    changes = {quantity: share[quantity.key] - 100 for quantity in (MASS, TORSION, BENDING)}
    gain = share[TORSION_PER_MASS.key] - 100
    return (
        f"{best.words.capitalize()} is the best: {change_text(gain)} torsional stiffness per mass. "
        + comparison_sentence("It", changes, "the original web")
    )


def _result_step(loop: LoopResult) -> int:
    return (loop.best or loop.steps[-1]).number


def _facts(loop: LoopResult) -> tuple[Fact, ...]:
    step, original = loop.steps[_result_step(loop)], loop.steps[0]
    return tuple(_fact(step, original, quantity) for quantity, _, _ in _LINES)


def _fact(step: StepRow, original: StepRow, quantity: Quantity) -> Fact:
    label = quantity.label.capitalize()
    change = step.percent_of_original[quantity.key] - 100
    error = f"{quantity.error}_error_percent"
    estimate = max(getattr(step, error), getattr(original, error)) if quantity.error else 0.0
    now, before = (_value_words(row, quantity) for row in (step, original))
    note = f"{step.words}: {now} against the original web's {before}"
    if abs(change) < estimate:
        return Fact(label, change_text(change), f"{note}, less than the error estimate", "neutral")
    status: FactStatus = "good" if quantity.better * change > 0 else "bad"
    return Fact(label, change_text(change), note, status)


def _ended(loop: LoopResult) -> Fact:
    return Fact("Ended", f"after {counted(loop.done, 'step')}", loop.stop_reason, "neutral")


def _value_words(row: StepRow, quantity: Quantity) -> str:
    return quantity_text(quantity, row.values()[quantity.key])


def _steps(loop: LoopResult) -> Section:
    figure = _steps_figure(loop)
    figure.set_facecolor("none")
    alt = "Mass, stiffnesses and stiffnesses per mass of every step in percent of the original web's"
    return Section(
        "steps",
        "Steps",
        f"Evaluated with fillets on body-fitted meshes; {steps_estimate(loop.steps)}. Every step keeps "
        "its web as TOML, STEP and STL in a folder beside this page."
        + "".join(f" Note: {notice}." for notice in loop.notices)
        + _handed_over(loop),
        steps_tables(loop.steps),
        (Picture("steps", figure, alt),),
    )


def _handed_over(loop: LoopResult) -> str:
    line = "; ".join(shape_lines(loop))
    return f" {line[0].upper()}{line[1:]}; see shape/report.html." if line else ""


def _provenance(loop: LoopResult, manifest: Manifest) -> Section:
    tables = (("Loop", pairs(origin_rows(manifest))), *assumed_tables(loop.assumed))
    return Section("provenance", "Where this comes from", tables=tables)


def save_steps_plot(path: Path, loop: LoopResult) -> None:
    """Write the plot as PNG; raises CranktopoError when the file cannot be written."""
    write_bytes(path, png(_steps_figure(loop)))


def _steps_figure(loop: LoopResult) -> Figure:
    figure = Figure(figsize=(5.0, 4.2), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    numbers = [step.number for step in loop.steps]
    names = [step.name or str(step.number) for step in loop.steps]
    done = len(numbers) - (names[-1] == SHAPE)
    for quantity, style, colour in _LINES:
        values = [step.percent_of_original[quantity.key] for step in loop.steps]
        label = f"{quantity.label}: {values[-1]:.1f} %"
        fill = "none" if style.endswith("--") else "full"
        axes.plot(numbers[:done], values[:done], style, color=colour, fillstyle=fill, label=label)
        axes.plot(numbers[done:], values[done:], style[0], color=colour, fillstyle=fill)
    axes.axhline(100.0, color="0.7", linewidth=1, zorder=0)
    if loop.best is not None:
        axes.axvline(loop.best.number, color="0.7", linestyle=":", zorder=0)
    axes.set(xlabel="step", ylabel="percent of the original web")
    axes.set_xticks(numbers, names)
    axes.set_title(f"{loop.design}: {loop.stop_reason}", fontsize=9, wrap=True)
    axes.tick_params(labelsize=8)
    figure.legend(fontsize=8, loc="outside lower center", ncols=2, frameon=False)
    return figure
