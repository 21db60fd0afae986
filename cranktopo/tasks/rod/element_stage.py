"""The strength of a design's rod by finite elements beside the closed form, and its files."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cranktopo.base.arrays import Array
from cranktopo.base.files import as_path_if_any, write_json
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.rod_forces import RodMotion
from cranktopo.runs.destination import check_folder
from cranktopo.tasks.rod.element_gradients import Quantity, RodGradients
from cranktopo.tasks.rod.element_stress import ElementStress
from cranktopo.tasks.rod.elements import rod_elements
from cranktopo.tasks.rod.pictures import write_rod_files
from cranktopo.tasks.rod.result import LighterRod, RodStrength
from cranktopo.tasks.rod.stage import loaded_rod, strength_of


@dataclass(frozen=True)
class RodOnElements:
    """Strength of a rod with that by elements, and the stresses under its cycles that it was found from."""

    strength: RodStrength
    stress: ElementStress
    motions: tuple[RodMotion, ...]

    def gradients(self, names: Sequence[str], quantities: Collection[Quantity]) -> dict[Quantity, Array]:
        """Return the derivatives of logarithms of quantities by dimensions of some names, (names,), 1/mm.

        Raises:
            CranktopoError: a failed solve.
        """
        return RodGradients(self.stress, self.motions, self.strength.method, names).of(quantities)

    def with_search(self, lighter: LighterRod) -> RodOnElements:
        """Return the same with the search that the rod was found by."""
        return replace(self, strength=self.strength.model_copy(update={"lighter": lighter}))


def check_rod_elements(
    design: DesignLike,
    method: str = "lsa",
    element_size_mm: float | None = None,
    contact: bool = False,
    out: Path | str | None = None,
) -> RodStrength:
    """Return the strength of a design's rod with that by finite elements beside it.

    Args:
        element_size_mm: by default one that gives rods of any size as many elements.
        contact: rigid pins touch the bores, in place of pressure by the cosine.
        out: folder for the result, a picture and a VTU file of the surface.

    Raises:
        CranktopoError: as `check_rod_strength`, no valid mesh, a failed solve, or a folder that holds files.
    """
    scene, out = as_scene(design), as_path_if_any(out)
    if out is not None:
        check_folder(out)
    found = rod_on_elements(scene, method, element_size_mm, contact)
    if out is not None:
        write_rod_folder(out, scene.name, found)
    return found.strength


def rod_on_elements(scene: Scene, method: str, element_size_mm: float | None, contact: bool) -> RodOnElements:
    """Do as `check_rod_elements`, with the stresses, and write nothing."""
    loaded = loaded_rod(scene, method)
    found = strength_of(scene, loaded)
    elements, stress = rod_elements(
        loaded.scene,
        loaded.motions,
        method,
        element_size_mm,
        contact=contact,
        least_preload_N=max(found.bolt.vdi_2230.least_preload_N, 0.0) if found.bolt else 0.0,
    )
    return RodOnElements(found.model_copy(update={"elements": elements}), stress, loaded.motions)


def write_rod_folder(out: Path, name: str, rod: RodOnElements) -> None:
    """Write the files of a rod by elements into a folder, pictures named after the design."""
    write_rod_files(out, name, rod.stress)
    write_json(out / "rod.json", rod.strength.as_json())
