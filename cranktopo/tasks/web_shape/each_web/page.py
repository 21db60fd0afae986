"""The page of `cranktopo shape --each-web`: both cranks, what each web carries, and how they differ."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.report.page import (
    Fact,
    Page,
    Section,
    assumed_tables,
    left_off_first,
    origin_rows,
    pairs,
    versions_section,
)
from cranktopo.report.plot import GREY, picture, plain
from cranktopo.report.result_table import ResultTable
from cranktopo.runs.manifest import Manifest
from cranktopo.tasks.web_shape.each_web.result import EachWebResult
from cranktopo.tasks.web_shape.each_web.text import (
    crank_table,
    dimension_table,
    each_web_headline,
    grouping_text,
    limits_text,
    load_table,
    round_table,
    search_table,
)

_BARS = 0.76
"""Width of all bars of a web together."""


def each_web_page(result: EachWebResult, manifest: Manifest) -> Page:
    """Return a finished run as content."""
    caption = f"Least safety of each web in its shaft; {result.required_safety:.3f} is required"
    return Page(
        title=f"Webs of their own on the crank of {result.design}",
        subtitle=f"Run {manifest.run}, {manifest.started[:10]}",
        headline=left_off_first(result.left_off, each_web_headline(result)),
        facts=_facts(result),
        sections=(
            Section(
                "cranks",
                "The whole crank",
                f"{limits_text(result)} {grouping_text(result)}",
                (("At equal limits", crank_table(result)), ("Rounds of searches", round_table(result))),
                (picture("safety-by-web", caption, draw_safeties, result),),
            ),
            Section(
                "loads",
                "What each web carries",
                "The shaft stands on all its main bearings, and each cylinder acts at its own phase. Moments "
                "in the middle of each web, largest less smallest over the cycle: in the plane of its throw, "
                "across it, and about the crank axis.",
                (("By web, from the free end", load_table(result)),),
            ),
            Section(
                "webs",
                "The webs",
                "Each was searched for as the web of a throw that has it twice, under the loads that it has "
                "in the shaft; these stay as they are within a search. Each search has a page of its own in "
                "its folder.",
                (("Searches", search_table(result)), *_differing(result)),
            ),
            Section(
                "provenance",
                "Where this comes from",
                tables=(("Run", pairs(origin_rows(manifest))), *assumed_tables(result.assumed)),
            ),
            versions_section(manifest.versions),
        ),
    )


def _differing(result: EachWebResult) -> tuple[tuple[str, ResultTable], ...]:
    table = dimension_table(result)
    return (("Dimensions that differ, mm or degrees", table),) if table.rows else ()


def _facts(result: EachWebResult) -> tuple[Fact, ...]:
    own, one = result.each_web.shaft, result.one_web.shaft
    return (
        Fact(
            "Mass of the crank",
            f"{own.mass_kg:.3f} kg",
            f"one web for all {one.mass_kg:.3f} kg, the design {result.original.mass_kg:.3f} kg",
            "good" if own.mass_kg < one.mass_kg else "neutral",
        ),
        Fact(
            "Least safety in the shaft",
            f"{own.safety:.3f}",
            f"required {result.required_safety:.3f}; one web for all {one.safety:.3f}",
            "good" if result.held else "bad",
        ),
        Fact(
            "Torsion end to end",
            f"{own.torsion_end_to_end_Nm_per_rad / 1000:.2f} kN m/rad",
            f"the design {result.original.torsion_end_to_end_Nm_per_rad / 1000:.2f} kN m/rad",
            "neutral",
        ),
        Fact("Different webs", str(len(result.each_web.groups)), grouping_text(result), "neutral"),
    )


def draw_safeties(axes: Any, result: EachWebResult) -> None:
    """Draw the least safety of each web with the design's web, one for all, and its own."""
    cranks = {
        "the design's web": result.original,
        "one web for all": result.one_web.shaft,
        "each its own": result.each_web.shaft,
    }
    webs, wide = np.array([web.web for web in result.original.webs]), _BARS / len(cranks)
    for number, (name, shaft) in enumerate(cranks.items()):
        axes.bar(webs + (number - (len(cranks) - 1) / 2) * wide, shaft.safeties, wide, label=name)
    axes.axhline(result.required_safety, color=GREY, ls="--", lw=1.0, label="required")
    axes.set_xticks(webs)
    axes.set(xlabel="web, from the free end", ylabel="least safety", ylim=(0, None))
    plain(axes)
