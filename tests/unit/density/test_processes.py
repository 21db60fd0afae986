"""Processes as blocks of the density chain: what a die with draft, a mould and a mill leave of any field."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.processes import ForgingConstraint
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.manufacturing import parting_of
from cranktopo.tasks.density.material import MaterialInterpolation, physical_density, smooth_density
from tests.physics.density.throw_cases import forged

CELL_MM = 6.0
PROCESSES: dict[str, dict[str, Any]] = {
    "die": {"process": "forged"},
    "drafted die": {"process": "forged", "draft_deg": 7.0},
    "die through the faces": {"process": "forged", "parting": "web_faces"},
    "drafted die through the faces": {"process": "forged", "parting": "web_faces", "draft_deg": 7.0},
    "mould": {"process": "cast"},
    "drafted mould": {"process": "cast", "draft_deg": 3.0},
    "mould through the faces": {"process": "cast", "parting": "web_faces", "draft_deg": 3.0},
    "mill": {"process": "milled", "tool_radius_mm": 6.0},
}
Cells = NDArray[np.bool_]


def chain_of(scene: Scene, extent: Any = "half", **settings: Any) -> tuple[Domain, MaterialInterpolation]:
    domain = build_domain(scene, CELL_MM, extent=extent)
    return domain, build_chain(forged(scene, filter_radius_mm=6.0, **settings), domain)


def noise(density_chain: MaterialInterpolation, seed: int = 0) -> jax.Array:
    """Blobs of solid and void a few cells wide, without any symmetry."""
    coarse = np.random.default_rng(seed).random(density_chain.design_fraction.shape)
    smooth = ndimage.gaussian_filter(coarse, 1.5)
    return jnp.asarray(np.clip(0.5 + 6 * (smooth - np.median(smooth)), 0, 1))


def solid_of(density_chain: MaterialInterpolation, seed: int, level: float = 0.5) -> Cells:
    made = jax.jit(physical_density)
    return np.asarray(made(density_chain, noise(density_chain, seed), 8.0)) > level


VARIANTS = (
    "drafted die",
    "die through the faces",
    "drafted die through the faces",
    "mould",
    "mould through the faces",
)


@pytest.fixture(
    params=[pytest.param(name, marks=pytest.mark.slow if name in VARIANTS else ()) for name in PROCESSES]
)
def made(request: pytest.FixtureRequest, float64: None, mikron: Scene) -> MaterialInterpolation:
    return chain_of(mikron, **PROCESSES[request.param])[1]


@pytest.mark.slow
def test_a_full_design_stays_full(made: MaterialInterpolation) -> None:
    free = np.asarray(made.design_fraction) > 0
    np.testing.assert_allclose(
        np.asarray(jax.jit(smooth_density)(made, jnp.ones(free.shape)))[free], 1.0, atol=1e-12
    )


def test_nothing_made_has_a_closed_hollow(made: MaterialInterpolation) -> None:
    """Every void joins the outside, face to face."""
    for seed in range(3):
        solid = np.pad(solid_of(made, seed) | (np.asarray(made.design_fraction) == 0), 1)
        bores = np.pad(np.asarray(made.design_fraction) == 0, 1)  # and what the padding of the grid leaves
        labels, _ = ndimage.label(~solid | bores)
        assert set(np.unique(labels[~solid])) <= {labels[0, 0, 0], *np.unique(labels[bores])}


def test_gradients(made: MaterialInterpolation) -> None:
    """Any weighting of the density, on fields without symmetry."""
    rng = np.random.default_rng(3)
    x = 0.2 + 0.6 * jnp.asarray(rng.random(made.design_fraction.shape))
    weights, direction = (jnp.asarray(rng.standard_normal(x.shape)) for _ in range(2))

    @jax.jit
    @jax.value_and_grad
    def both(x: jax.Array) -> jax.Array:
        return jnp.sum(weights * physical_density(made, x, 4.0))

    step = 1e-6
    expected = (both(x + step * direction)[0] - both(x - step * direction)[0]) / (2 * step)
    assert float(jnp.sum(both(x)[1] * direction)) == pytest.approx(float(expected), rel=1e-5)


@pytest.mark.parametrize("parting", ["lateral", "web_faces"])
def test_layers_of_a_drafted_die_shrink_outward(float64: None, mikron: Scene, parting: str) -> None:
    """Solid m layers out keeps tan(draft) times their distance from the void of the inner layer."""
    draft = 12.0
    domain, density_chain = chain_of(mikron, process="forged", parting=parting, draft_deg=draft)
    die = density_chain.process
    assert isinstance(die, ForgingConstraint)
    dx, dy, dz = (float(step[0]) for step in domain.grid.steps_mm)
    dz = float(np.diff(domain.grid.z_mm)[domain.web_layers[0]])
    steps = [dx, dy, dz]
    along = steps.pop(die.axis)
    free = np.moveaxis(np.asarray(density_chain.design_fraction) > 0, die.axis, 0)
    ignored = ~free if die.kept is None else ~free | np.moveaxis(np.asarray(die.kept) > 0, die.axis, 0)
    for seed in range(2):
        solid = np.moveaxis(solid_of(density_chain, seed), die.axis, 0) | ~free
        for side in (slice(die.parting[1], None), slice(die.parting[0] - 1, None, -1)):
            layers, apart = solid[side], ignored[side]
            for inner in range(len(layers)):
                if layers[inner].all():
                    continue
                depth = ndimage.distance_transform_edt(layers[inner], sampling=steps)
                for outer in range(inner + 1, len(layers)):
                    kept = layers[outer] & ~apart[outer] & free[side][inner]
                    least = (outer - inner) * along * np.tan(np.radians(draft))
                    assert np.all(depth[kept] >= least - max(steps))
                    assert np.all(layers[inner][kept])


def test_a_prism_becomes_a_wedge(float64: None) -> None:
    """The 0.5 surface of a straight bar, 48 layers outward, recedes by tan(draft) per length."""
    step, draft, half_width = 1.0, 10.0, 14.0
    y = step * (np.arange(60) - 29.5)
    bar = np.clip(0.5 + (half_width - np.abs(y)) / 8.0, 0, 1)
    field = jnp.asarray(np.broadcast_to(bar[None, :, None], (48, 60, 5)))
    slope = float(np.tan(np.radians(draft)))
    made = np.asarray(ForgingConstraint(jnp.ones(field.shape, bool), None, 0, (0, 0), (slope, slope))(field))[
        :, :, 2
    ]
    widths = [np.interp(0.5, row[30:][::-1], y[30:][::-1]) for row in made]
    fitted = np.polyfit(np.arange(6, 48), widths[6:], 1)[0]
    assert -fitted == pytest.approx(slope, rel=0.05)
    assert widths[0] == pytest.approx(half_width, abs=0.2)


def test_no_die_sinks_a_pocket_behind_a_journal(float64: None, mikron: Scene) -> None:
    domain, density_chain = chain_of(mikron, process="forged", parting="web_faces")
    smoothed = jax.jit(smooth_density)
    density = np.asarray(smoothed(density_chain, jnp.zeros(density_chain.design_fraction.shape)))
    x, y = ((nodes[1:] + nodes[:-1]) / 2 for nodes in (domain.grid.x_mm, domain.grid.y_mm))
    free = np.asarray(density_chain.design_fraction) > 0
    middle = density.shape[2] // 2
    for centre, layers in ((0.0, slice(0, middle)), (48.0, slice(middle, None))):
        radius = np.hypot(x[:, None], y[None, :] - centre)
        for low, high, least, most in ((0, 13, 1, 1), (13, 21, 0.5, 1), (23, 32, 0, 0.5), (32, 200, 0, 0.05)):
            ring = (radius >= low) & (radius < high)
            found = density[ring][:, layers][free[ring][:, layers]]
            assert np.all((found >= least) & (found <= most))


def lines_of(cells: Cells, axis: int) -> Cells:
    moved = np.moveaxis(cells, axis, -1)
    return moved.reshape(-1, moved.shape[-1])


@pytest.mark.parametrize(("parting", "axis"), [("lateral", 0), ("web_faces", 2)])
def test_a_mould_leaves_one_piece_on_each_line(float64: None, mikron: Scene, parting: str, axis: int) -> None:
    """Between two solids of a line there is no void; a die's piece crosses its parting plane as well."""
    _, density_chain = chain_of(mikron, process="cast", parting=parting)
    solid, free = (
        lines_of(solid_of(density_chain, 1), axis),
        lines_of(np.asarray(density_chain.design_fraction) > 0, axis),
    )
    between = np.logical_or.accumulate(solid, 1) & np.logical_or.accumulate(solid[:, ::-1], 1)[:, ::-1]
    assert not np.any(between & free & ~solid)
    crossing = [row[len(row) // 2 - 1] or row[len(row) // 2] for row in solid if row.any()]
    assert not all(crossing)


def reached_by_a_mill(solid: Cells, scene: Scene, domain: Domain, radius_mm: float) -> Cells:
    """Cells that a flat-ended mill can clear without touching solid, from both faces and both sides."""
    m = 4
    x, y, z = (np.asarray(step) for step in domain.grid.steps_mm)
    steps = float(x[0]), float(y[0]), float(z[domain.web_layers[0]])
    block = np.pad(solid, m)
    cx, cy = (
        (nodes[0] + step * (np.arange(-m, len(nodes) - 1 + m) + 0.5))
        for nodes, step in ((domain.grid.x_mm, steps[0]), (domain.grid.y_mm, steps[1]))
    )
    for (journal, centre), layers in zip(scene.throw.journals, (slice(0, m), slice(-m, None)), strict=True):
        disc = np.hypot(cx[:, None], cy[None, :] - centre) < journal.radius_mm
        block[:, :, layers] |= disc[:, :, None]
    found = np.zeros_like(block)
    for axis, sign in ((2, 1), (2, -1), (0, 1), (0, -1)):
        moved = np.moveaxis(block, axis, 0)[::sign]
        a, b = (step for other, step in enumerate(steps) if other != axis)
        i, j = np.mgrid[-m : m + 1, -m : m + 1]
        tool = np.hypot(i * a, j * b) <= radius_mm * (1 + 1e-9)
        hit = np.stack([ndimage.binary_dilation(layer, tool) for layer in moved])
        centres = ~np.logical_or.accumulate(hit, axis=0)
        cleared = np.stack([ndimage.binary_dilation(layer, tool) for layer in centres])
        found |= np.moveaxis(cleared[::sign], 0, axis)
    return found[m:-m, m:-m, m:-m]


@pytest.mark.parametrize("radius_mm", [1.0, 6.5, pytest.param(13.0, marks=pytest.mark.slow)])
def test_a_mill_reaches_every_void(float64: None, mikron: Scene, radius_mm: float) -> None:
    domain, density_chain = chain_of(mikron, process="milled", tool_radius_mm=radius_mm)
    free = np.asarray(density_chain.design_fraction) > 0
    for level in (0.3, 0.5, 0.7):
        solid = solid_of(density_chain, 2, level) & free
        reached = reached_by_a_mill(solid, mikron, domain, radius_mm)
        void = free & ~solid
        assert void.sum() > 100
        assert np.all(reached[void])


@pytest.mark.parametrize(
    "radius_mm",
    [
        pytest.param(6.0, id="usual"),
        pytest.param(40.0, id="wider than the web", marks=pytest.mark.slow),
    ],
)
def test_the_mill_of_the_quarter_is_that_of_the_half(float64: None, mikron: Scene, radius_mm: float) -> None:
    (_, quarter), (_, half) = (
        chain_of(mikron, extent, process="milled", tool_radius_mm=radius_mm) for extent in ("quarter", "half")
    )
    x = noise(quarter, 2)
    n, _ = parting_of(build_domain(mikron, CELL_MM, extent="half"))
    mirrored = jnp.zeros(half.design_fraction.shape).at[: 2 * n].set(jnp.concatenate([x[:n][::-1], x[:n]]))
    inside = np.asarray(quarter.design_fraction)[:n] > 0
    smoothed = jax.jit(smooth_density)
    both, one = (np.asarray(smoothed(*of)) for of in ((half, mirrored), (quarter, x)))
    np.testing.assert_allclose(both[n : 2 * n][inside], one[:n][inside], rtol=1e-9, atol=1e-9)


def test_a_wide_mill_costs_no_longer_expression(float64: None, mikron: Scene) -> None:
    """Offsets written out one by one: minutes of compiling, and a derivative of 40 times the value."""

    def operations(radius_mm: float) -> int:
        block = chain_of(mikron, process="milled", tool_radius_mm=radius_mm)[1].process
        assert block is not None
        field = jax.ShapeDtypeStruct(block.free.shape, float)
        return jax.jit(lambda x: jax.vjp(block, x)[1](x)[0]).lower(field).as_text().count("\n")

    assert operations(30.0) == operations(12.0)
