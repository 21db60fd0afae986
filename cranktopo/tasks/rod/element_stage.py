"""The strength of a design's rod by finite elements beside the closed form, and its files."""

from __future__ import annotations

from pathlib import Path

from cranktopo.base.files import as_path, write_json
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.runs.destination import check_folder
from cranktopo.tasks.rod.elements import rod_elements
from cranktopo.tasks.rod.pictures import write_rod_files
from cranktopo.tasks.rod.result import RodStrength
from cranktopo.tasks.rod.stage import loaded_rod, strength_of


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
        out: folder for a picture and a VTU file of the surface.

    Raises:
        CranktopoError: as `check_rod_strength`, no valid mesh, a failed solve, or a folder that holds files.
    """
    scene, out = as_scene(design), as_path(out)
    if out is not None:
        check_folder(out)
    loaded = loaded_rod(scene, method)
    found = strength_of(scene, loaded)
    elements, stress = rod_elements(loaded.scene, loaded.motions, method, element_size_mm, contact=contact)
    told = found.model_copy(update={"elements": elements})
    if out is not None:
        write_rod_files(out, scene.name, stress)
        write_json(out / "rod.json", told.as_json())
    return told
