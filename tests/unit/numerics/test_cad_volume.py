"""Volumes by quadratic triangles: closed forms, whatever way triangles turn, and bodies of the CAD kernel."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.checked import ClosedForm, check_body, solid_properties
from cranktopo.numerics.cad_volume import moments_of, triangulated_moments, triangulated_volume_mm3
from cranktopo.numerics.gmsh_session import cad_session


def prism() -> tuple[np.ndarray, np.ndarray]:
    """A tetrahedron of volume 1/6 off the origin, with straight six-node triangles."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + 7.0
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    nodes, numbers = list(corners), {}
    for a, b in itertools.combinations(range(4), 2):
        numbers[a, b] = numbers[b, a] = len(nodes)
        nodes.append((corners[a] + corners[b]) / 2)
    edges = [[numbers[f[i], f[(i + 1) % 3]] for i in range(3)] for f in faces]
    return np.array(nodes), np.hstack([faces, edges])


def test_a_tetrahedron_is_exact_whatever_way_its_faces_turn() -> None:
    nodes, triangles = prism()
    turned = triangles.copy()
    turned[[1, 3]] = turned[[1, 3]][:, [0, 2, 1, 5, 4, 3]]
    for faces in (triangles, turned):
        assert moments_of(nodes, faces).volume == pytest.approx(1 / 6, rel=1e-12)


def test_curved_faces_count_with_their_edge_nodes() -> None:
    """A node in the middle of an edge, moved by h, moves a third of a face of area 1/2."""
    nodes, triangles = prism()
    h, middle = 1e-6, triangles[0, 3]
    nodes[middle] -= (0.0, 0.0, h)
    assert moments_of(nodes, triangles).volume - 1 / 6 == pytest.approx(h / 6, rel=1e-3)


@pytest.mark.parametrize("beside", [False, True])
def test_a_ring_cut_in_its_plane(beside: bool) -> None:
    """Another body in the session does not count."""
    with cad_session("a ring") as gmsh:
        occ = gmsh.model.occ
        if beside:
            occ.addBox(0, 0, 50, 10, 10, 10)
        ring = occ.addTorus(0, 0, 0, 20.0, 5.0)
        cut, _ = occ.cut([(3, ring)], [(3, occ.addBox(-30, -30, 0, 60, 60, 10))])
        found = triangulated_volume_mm3(cut[0][1])
        assert not gmsh.model.mesh.getNodes()[0].size
    assert found == pytest.approx(math.pi**2 * 20 * 5**2, rel=1e-5)


def test_centre_and_inertia_of_a_bar_off_the_axis() -> None:
    with cad_session("a bar") as gmsh:
        bar = gmsh.model.occ.addCylinder(30, 40, 5, 0, 0, 60, 10)
        found = triangulated_moments(bar)
    volume = math.pi * 10**2 * 60
    assert found.volume == pytest.approx(volume, rel=2e-5)
    assert found.centre == pytest.approx((30, 40, 35), abs=1e-3)
    assert found.polar == pytest.approx(volume * (10**2 / 2 + 50**2), rel=2e-5)


class Kernel:
    """A CAD kernel whose integration is wrong by a share."""

    def __init__(self, occ: object, share: float) -> None:
        self._occ, self._share = occ, share

    def __getattr__(self, name: str) -> object:
        return getattr(self._occ, name)

    def getMass(self, *pair: int) -> float:
        return self._occ.getMass(*pair) * (1 + self._share)  # type: ignore[attr-defined, no-any-return]


def check(integration: float, body: float) -> None:
    """Check a cylinder that is off by a share of its volume, in a kernel that integrates as much off."""
    with cad_session("a cylinder") as gmsh:
        solid = [(3, gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 10 * (1 + body), 20))]
        check_body(Kernel(gmsh.model.occ, integration), solid, ClosedForm(math.pi * 20**2 * 10), "cylinder")


def test_integration_that_is_a_little_off_is_no_fault_of_the_body() -> None:
    check(integration=5e-5, body=0.0)
    check(integration=1e-3, body=0.0)


def test_masses_are_those_of_triangles_where_the_kernel_integrates_wrong() -> None:
    form = ClosedForm(math.pi * 20**2 * 10)
    with cad_session("a cylinder") as gmsh:
        solid = [(3, gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 10, 20))]
        wrong = Kernel(gmsh.model.occ, 1e-3)
        found, told = solid_properties(wrong, solid, form), solid_properties(wrong, solid)
    assert found.volume_mm3 == pytest.approx(form.volume_mm3, rel=1e-5)
    assert found.inertia_z_mm5 == pytest.approx(form.volume_mm3 * 20**2 / 2, rel=2e-5)
    assert told.volume_mm3 == pytest.approx(1.001 * form.volume_mm3, rel=1e-9), (
        "without a form it is the kernel's"
    )


@pytest.mark.parametrize(("integration", "body"), [(0.0, 5e-5), (3e-3, 0.0), (-5e-5, 9e-5)])
def test_a_body_that_is_off_is_refused(integration: float, body: float) -> None:
    with pytest.raises(CranktopoError, match="closed form"):
        check(integration, body)
