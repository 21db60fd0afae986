"""A body that is meshed twice is built once, and its second mesh is that of a new one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import gmsh
import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.mesh import solid_mesh
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.numerics import gmsh_session
from cranktopo.numerics.gmsh_session import body_session, cad_session, keeping_bodies


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[Scene]:
    """Scenes whose half throw was built."""
    scenes: list[Scene] = []
    add = solid_mesh.add_half_throw
    monkeypatch.setattr(
        solid_mesh, "add_half_throw", lambda occ, scene, **how: scenes.append(scene) or add(occ, scene, **how)
    )
    return scenes


@pytest.fixture(autouse=True)
def kept() -> Iterator[None]:
    """Bodies are kept in every test here, and none after it."""
    with keeping_bodies():
        yield
    assert not gmsh.isInitialized()


def _close() -> None:
    with cad_session("another"):
        pass


def _assert_alike(one: MeshedThrow, two: MeshedThrow) -> None:
    assert one.body == two.body
    np.testing.assert_array_equal(one.mesh.points_mm, two.mesh.points_mm)
    np.testing.assert_array_equal(one.mesh.cells, two.mesh.cells)


def test_the_second_mesh_of_a_kept_body_is_that_of_a_new_one(mikron: Scene, built: list[Scene]) -> None:
    _close()
    new = [mesh_throw(mikron, 18.0), mesh_throw(mikron, 18.0, fillet_fraction=1.0)]
    assert len(built) == 1
    for number, fraction in enumerate((1.0, None)):
        _close()
        _assert_alike(mesh_throw(mikron, 18.0, fillet_fraction=fraction), new[1 - number])
    assert len(built) == 3


def test_another_body_is_built(mikron: Scene, built: list[Scene]) -> None:
    _close()
    thicker = mikron.model_copy(update={"web": mikron.web.model_copy(update={"thickness_mm": 20.0})})
    first, second = mesh_throw(mikron, 18.0), mesh_throw(thicker, 18.0)
    assert len(built) == 2
    assert second.body.volume_mm3 > first.body.volume_mm3
    mesh_throw(thicker, 18.0, quarter=False)  # both signs of x
    assert len(built) == 3


def test_a_failure_closes_the_session() -> None:
    def build(gmsh: object) -> int:
        return 1

    with pytest.raises(CranktopoError, match="gmsh failed"), body_session("a body", "key", build):
        raise Exception("no mesh")
    with body_session("a body", "key", lambda gmsh: 2) as (_, found):
        assert found == 2, "what failed was kept"
    _close()


def test_a_kept_body_is_not_in_the_next_session(mikron: Scene) -> None:
    mesh_throw(mikron, 18.0)
    with cad_session("empty") as gmsh:
        assert gmsh.model.getEntities(3) == []


def test_nothing_is_left_open_where_nobody_keeps_it(mikron: Scene) -> None:
    with _without_keepers():
        mesh_throw(mikron, 18.0)
        assert not gmsh.isInitialized()


@contextmanager
def _without_keepers() -> Iterator[None]:
    keepers, gmsh_session._KEEPERS[:] = list(gmsh_session._KEEPERS), []
    yield
    gmsh_session._KEEPERS[:] = keepers
