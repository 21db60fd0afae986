"""A web that was found as a throw that has it twice, beside a throw whose halves differ: counted alike."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.halves import WebName, difference
from cranktopo.design.loading import one_web
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, resolve_targets


def counted_alike(
    texts: Sequence[TargetLike], targets: Sequence[Target], *, fillets: bool = False
) -> tuple[list[Target], str]:
    """Return targets of which each has the same web twice where one has, and the line that says so.

    A throw with `throw.mirrored_web` has both what its web gained and once more what the mirroring changed in
    the other half. Beside a throw whose halves differ only the first counts: of this throw the same web is
    taken twice, as optimisers do for their limits.

    Args:
        texts: what the user typed for each target.
        fillets: keep those that the plan of a design leaves out.

    Raises:
        CranktopoError: first and second webs, or a body from CAD whose halves differ, are among them.
    """
    mirrored = [row for row, target in enumerate(targets) if target.scene.throw.mirrored_web]
    unlike = [row for row, target in enumerate(targets) if difference(_design(target))]
    if not mirrored or not unlike:
        return list(targets), ""
    web = _the_web([targets[row] for row in mirrored])
    taken: list[Target | Scene] = list(targets)
    for row in unlike:
        if targets[row].file is not None:
            raise CranktopoError(
                f"{targets[row].name} is a body from CAD whose halves differ, and "
                f"{targets[mirrored[0]].name} has its {web} web twice (throw.mirrored_web).",
                hint=f"Put that web on the throw first: {_pair(texts[unlike[0]], texts[mirrored[0]], web)}",
            )
        taken[row] = one_web(_design(targets[row]), web)
    found = resolve_targets(taken, fillets=fillets, whole=True)
    names, others = ([targets[row].name for row in rows] for rows in (mirrored, unlike))
    line = (
        f"{', '.join(names)}: a throw that has its {web} web twice (throw.mirrored_web). So "
        f"{', '.join(others)} counts with its {web} web twice as well "
        f"({', '.join(found[row].name for row in unlike)}): changes and limits are those of the {web} web, "
        f"not of the throw. On its throw: {_pair(texts[unlike[0]], texts[mirrored[0]], web)}"
    )
    return found, line


def _design(target: Target) -> Scene:
    return target.design or target.scene


def _the_web(mirrored: Sequence[Target]) -> WebName:
    """Return the web that all have twice."""
    found = {target.name: target.scene.throw.mirrored_web for target in mirrored}
    webs = sorted({web for web in found.values() if web})
    if len(webs) > 1:
        raise CranktopoError(
            f"{' and '.join(f'{name} has its {web} web twice' for name, web in found.items())} "
            "(throw.mirrored_web), and the halves of another target differ.",
            hint="Compare first and second webs apart, or put both on the throw: cranktopo designs pair.",
            code=ExitCode.USAGE,
        )
    return webs[0]


def _pair(design: TargetLike, found: TargetLike, web: WebName) -> str:
    return pair_command(_word(design), _word(found), web)


def pair_command(design: str, found: str, web: WebName) -> str:
    """Return the command that puts a web that was found on the throw of its design."""
    return shlex.join(["cranktopo", "designs", "pair", design, "pair.toml", f"--{web}", found])


def next_line(scene: Scene, design: str, run: Path, *before: str) -> str:
    """Return the commands that put the web of a finished run on the throw; empty where both halves are alike.

    Args:
        before: words of the command that the run needs first, without the run.
    """
    web = scene.throw.mirrored_web
    if web is None:
        return ""
    first = f"{shlex.join([*before, str(run)])}, then " if before else ""
    return f"on the throw: {first}{pair_command(design, str(run), web)}"


def _word(text: TargetLike) -> str:
    return str(text) if isinstance(text, str | Path) else text.name
