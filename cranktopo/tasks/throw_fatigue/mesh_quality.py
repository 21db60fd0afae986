"""Quality of a mesh for stresses: the checks of IACS UR M53, Appendix III, beside their limits."""

from __future__ import annotations

from dataclasses import dataclass

NORMAL_LIMIT_PERCENT, JUMP_LIMIT_PERCENT, EDGE_LIMIT = 3.0, 5.0, 0.25
"""Limits of IACS UR M53, Appendix III: surface-normal stress, jump between elements, edges in a fillet over
its radius."""


@dataclass(frozen=True)
class MeshCheck:
    """One check of the rule on a mesh: its value beside the limit, both in % or bare numbers."""

    name: str
    value: float
    at_most: float
    unit: str = "%"

    @property
    def kept(self) -> bool:
        """True if the value is within the limit."""
        return self.value <= self.at_most

    def __str__(self) -> str:
        least, unit = (1, " %") if self.unit == "%" else (4, "")
        digits = next((n for n in range(least, 9) if (round(self.value, n) <= self.at_most) == self.kept), 9)
        return f"{self.name} {self.value:.{digits}f}{unit} (at most {self.at_most:g}{unit})"


class _RuleChecks:
    """Checks of the rule on a mesh, beside their limits."""

    normal_percent: float
    jump_percent: float

    @property
    def within_limits(self) -> bool:
        """True if every check is within its limit."""
        return all(check.kept for check in self.checks)

    @property
    def shortfall(self) -> str:
        """The checks that the mesh misses beside their limits in words."""
        missed = [str(check) for check in self.checks if not check.kept]
        return f"the mesh misses the checks of IACS UR M53: {', '.join(missed)}"

    @property
    def kept(self) -> str:
        """All checks beside their limits in words."""
        return ", ".join(map(str, self.checks))

    @property
    def checks(self) -> tuple[MeshCheck, ...]:
        """Checks at the peaks of the stress, then of the mesh itself."""
        return (
            MeshCheck("surface-normal stress", self.normal_percent, NORMAL_LIMIT_PERCENT),
            MeshCheck("jump between elements", self.jump_percent, JUMP_LIMIT_PERCENT),
        )


@dataclass(frozen=True)
class MeshChecks(_RuleChecks):
    """The rule's checks of a mesh at one place: surface-normal stress, and jump between elements, %."""

    normal_percent: float
    jump_percent: float


@dataclass(frozen=True)
class Quality(_RuleChecks):
    """Mesh and the rule's quality checks where each unit load stresses each fillet most.

    Attributes:
        fillet_size_mm: element size asked for in the finer fillet.
        longest_edge: longest element edge in the fillets over the fillet's (least) radius.
        nodes: nodes of the mesh.
        normal_percent: surface-normal stress over the largest principal stress of the same node, worst; by
            the stresses that are judged, means over elements or fitted polynomials.
        jump_percent: departure of an element's von Mises stress from that of the nodal mean over the latter,
            worst.
        mesh_seconds: time for the mesh.
        solve_seconds: time for the unit loads.
    """

    fillet_size_mm: float
    longest_edge: float
    nodes: int
    normal_percent: float
    jump_percent: float
    mesh_seconds: float
    solve_seconds: float


@dataclass(frozen=True)
class RuleQuality(Quality):
    """The same of a mesh by which the rule judges, which limits the edges in the fillets as well."""

    @property
    def checks(self) -> tuple[MeshCheck, ...]:
        """Checks at the peaks of the stress, and of the edges in the fillets."""
        edge = MeshCheck("longest edge in a fillet over its radius", self.longest_edge, EDGE_LIMIT, "-")
        return (*super().checks, edge)


@dataclass(frozen=True)
class JudgedQuality(Quality):
    """Mesh and the rule's quality checks, and whether they are kept.

    Attributes:
        within_rule: all checks are within the limits of the rule.
    """

    within_rule: bool
