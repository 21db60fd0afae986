"""One of two different webs as a throw of its own, for what optimises one web."""

from __future__ import annotations

from typing import Literal

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.checks.scene import check_scene
from cranktopo.design.halves import difference, halves, of_second
from cranktopo.design.schema import Scene

WebName = Literal["first", "second"]


def one_web(scene: Scene, web: WebName | None) -> Scene:
    """The throw that has a web of a scene twice, with its journals; the scene itself where halves are alike.

    A drilling in that half alone has a mirror image there.

    Args:
        web: which one; must be given where the halves differ, and only there.

    Raises:
        CranktopoError: it is missing, there is nothing to choose, a body from CAD stands for the original, or
            the half is no throw of its own.
    """
    key = difference(scene)
    if web is None and key:
        raise CranktopoError(
            f"{key}: the halves of the throw differ, and one web is optimised at a time.",
            hint="Give optimise, bound, shape, iterate or evaluate --sensitivities --web first or "
            "--web second: the other half is then taken as its mirror image.",
        )
    if web is None:
        return scene
    if not key:
        raise CranktopoError(
            f"--web {web}: both halves of the throw are alike.", hint="Leave it out.", code=ExitCode.USAGE
        )
    if scene.original is not None:
        raise CranktopoError(
            f"--web {web}: the body of original.file is one half throw, and the halves differ.",
            hint="Take [original] out: gains are then measured against the web of the design.",
        )
    half = _twice(halves(scene)[web == "second"], web)
    try:
        check_scene(half)
    except CranktopoError as error:
        raise of_second(error, scene) if web == "second" else error from None
    return half


def _twice(half: Scene, web: WebName) -> Scene:
    drilling = tuple(one.model_copy(update={"web": "both"}) for one in half.throw.drilling)
    throw = half.throw.model_copy(update={"drilling": drilling, "mirrored_web": web})
    return half.model_copy(update={"throw": throw, "name": f"{half.name}-{web}-web"})
