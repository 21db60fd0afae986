"""Random throws with every feature, written as STEP by one CAD kernel and examined by another.

`python -m tests.studies.second_kernel FIRST COUNT > LINES` prints a JSON line for each part of each seed;
`python -m tests.studies.second_kernel table LINES...` sums them up. Needs the optional extra `cad-check`.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.formats import SolidPart
from cranktopo.bodies.crank_drillings import taken_beyond
from cranktopo.bodies.crank_ends import ends_volume_mm3
from cranktopo.bodies.solid.checked import ROUNDING_TOLERANCE, ClosedForm
from cranktopo.bodies.solid.files import bolted_bodies, export_solid
from cranktopo.bodies.solid.throw import half_form, throw_form
from cranktopo.bodies.volume import bolted_volume_mm3
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import difference, halves
from cranktopo.design.schema import Scene
from tests.cad_check.second_kernel import examined
from tests.featured_throws import featured_crank, featured_throw, features_of

VOLUME = 1e-6
"""Largest relative difference from the closed form, beside 5 % of what roundings of outlets take."""
LARGEST_TOLERANCE_MM = 1e-3
MESH_ERROR = 0.02
EVERY_HALF, EVERY_CRANK = 4, 20
"""Of how many seeds one is written as a half throw, and as a whole crank, too."""
Row = dict[str, Any]


def rows(seed: int, folder: Path) -> Iterator[Row]:
    """What is found of each part of a seed's throw."""
    scene = featured_throw(seed)
    yield _row(scene, "throw", seed, folder)
    if seed % EVERY_HALF == 0 and not difference(scene):
        yield _row(scene, "half", seed, folder)
    if seed % EVERY_CRANK == 0:
        yield _row(featured_crank(seed), "crankshaft", seed, folder)


def _row(scene: Scene, part: SolidPart, seed: int, folder: Path) -> Row:
    row: Row = {"seed": seed, "part": part, "features": sorted(features_of(scene))}
    path, start = folder / f"{seed}-{part}.step", time.process_time()
    try:
        export_solid(scene, part, path)
    except CranktopoError as error:
        return row | {"refused": str(error), "export_s": time.process_time() - start}
    written = time.process_time()
    beside = 0 if part == "half" else len(bolted_bodies(scene, part))
    found, form = examined(path, 1 + beside), _form(scene, part)
    row |= asdict(found) | {"export_s": written - start, "check_s": time.process_time() - written}
    path.unlink()
    missing = sorted(_round_fillets(scene, part) - set(found.tori_mm))
    off = found.volume_mm3 - form.volume_mm3
    return row | {
        "off": off / form.volume_mm3,
        "off_roundings": off / form.roundings_mm3 if form.roundings_mm3 else None,
        "allowed": VOLUME + ROUNDING_TOLERANCE * form.roundings_mm3 / form.volume_mm3,
        "missing_tori": missing,
    }


def _form(scene: Scene, part: SolidPart) -> ClosedForm:
    """The closed form of a part with the counterweights that are bolted to it, bodies of their own."""
    if part == "half":
        return half_form(scene)
    throws = throw_scenes(scene) if part == "crankshaft" else (scene,)
    forms = [throw_form(throw) for throw in throws]
    volume = sum(form.volume_mm3 for form in forms) + sum(map(_bolted_mm3, throws))
    if part == "crankshaft":
        volume += ends_volume_mm3(scene) - taken_beyond(scene).volume
    return ClosedForm(volume, sum(form.roundings_mm3 for form in forms))


def _bolted_mm3(throw: Scene) -> float:
    weights = ((half, half.web.counterweight) for half in halves(throw))
    return sum(bolted_volume_mm3(half) for half, weight in weights if weight is not None and weight.bolted)


def _round_fillets(scene: Scene, part: SolidPart) -> set[tuple[float, float]]:
    """Radii of the tori that the round fillets of a part must be."""
    throws = throw_scenes(scene) if part == "crankshaft" else (scene,)
    journals = [journal for throw in throws for half in halves(throw) for journal, _ in half.throw.journals]
    return {
        (round(one.radius_mm + one.fillet_mm, 6), round(one.fillet_mm, 6))
        for one in journals
        if one.fillet_mm and one.fillet.round
    }


def faults(row: Row) -> list[str]:
    """What is wrong with a part, in words without numbers, as classes to count."""
    if "refused" in row:
        return [f"refused: {row['refused'].split(': ')[1].split(',')[0]}"]
    found = [" ".join(word for word in fault.split() if not word.isdigit()) for fault in row["faults"]]
    found += [f"{name}" for name in row["disguised"]]
    if abs(row["off"]) > row["allowed"]:
        found.append("volume")
    if row["missing_tori"]:
        found.append("a fillet is no torus")
    if row["tolerance_mm"] > LARGEST_TOLERANCE_MM:
        found.append(f"tolerance above {LARGEST_TOLERANCE_MM:g} mm")
    if not abs(row["mesh_error"]) < MESH_ERROR:
        found.append("volume of the triangles")
    return sorted(set(found))


def table(lines: Sequence[Row]) -> Iterator[str]:
    """The sums of a run as Markdown: parts, faults, faces, features."""
    yield "| part | files | sound | volume | rounded outlets | of what these take | tolerance, mm | CPU s |"
    yield "| --- | --: | --: | --: | --: | --: | --: | --: |"
    for part in ("half", "throw", "crankshaft"):
        own = [row for row in lines if row["part"] == part]
        read = [row for row in own if "refused" not in row]
        if read:
            yield _part_line(part, own, read)
    for title, counts in (
        ("fault", Counter(fault for row in lines for fault in faults(row))),
        ("type of face", _sum(row["kinds"] for row in lines if "kinds" in row)),
        ("feature", Counter(name for row in lines if row["part"] == "throw" for name in row["features"])),
    ):
        yield from ("", f"| {title} | number |", "| --- | --: |")
        yield from (f"| {name} | {count:,} |" for name, count in counts.most_common())


def _part_line(part: str, own: Sequence[Row], read: Sequence[Row]) -> str:
    """Numbers of files, largest differences from the closed form and largest tolerance, time."""
    rounded = [row for row in read if row["off_roundings"] is not None]
    sharp = [row for row in read if row["off_roundings"] is None]
    columns = (sharp, "off"), (rounded, "off"), (rounded, "off_roundings"), (read, "tolerance_mm")
    worst = [max((abs(row[key]) for row in some), default=0.0) for some, key in columns]
    seconds = sum(row["export_s"] + row.get("check_s", 0.0) for row in own)
    sound = sum(not faults(row) for row in own)
    numbers = " | ".join(f"{one:.1e}" for one in worst)
    return f"| {part} | {len(own)} | {sound} | {numbers} | {seconds:.0f} |"


def _sum(counts: Iterator[dict[str, int]]) -> Counter[str]:
    total: Counter[str] = Counter()
    for one in counts:
        total.update(one)
    return total


def main(arguments: Sequence[str]) -> None:
    """Examine seeds, or sum up what was found of them."""
    if arguments[0] == "table":
        found = [json.loads(line) for name in arguments[1:] for line in Path(name).read_text().splitlines()]
        print("\n".join(table(found)))
        return
    first, count = map(int, arguments)
    with TemporaryDirectory() as folder:
        for seed in range(first, first + count):
            for row in rows(seed, Path(folder)):
                print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
