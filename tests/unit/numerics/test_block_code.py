"""Products with symmetric matrices of 3x3 blocks: any number of columns, and nothing beside them."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from cranktopo.numerics.tetrahedra import block_code
from cranktopo.numerics.tetrahedra.block_code import product

ROWS, FACTOR = 40, -0.7
GUARD = 64
"""Numbers behind an array that are neither used nor written."""


def guarded(values: np.ndarray) -> np.ndarray:
    """Return an array with numbers behind it that spoil whatever uses them."""
    found = np.full(values.size + GUARD, np.nan, dtype=values.dtype)
    found[: values.size] = values.ravel()
    return found


@pytest.mark.parametrize(
    ("parts", "threads"),
    [((ROWS, ROWS), True), ((12, 25), True), ((0, 25), True), ((25, 25), True), ((12, 25), False)],
)
@pytest.mark.parametrize("kind", ["float", "double"])
@pytest.mark.parametrize(
    ("width", "masks"),
    [(width, True) for width in (1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 15, 16, 19)] + [(7, False)],
)
def test_a_product_is_that_of_the_whole_matrix(
    width: int,
    kind: str,
    masks: bool,
    parts: tuple[int, int],
    threads: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With and without masks of lanes, and a system that begins threads, with rows between or none."""
    monkeypatch.setattr(block_code, "_has_masks", lambda: masks)
    monkeypatch.setattr(block_code, "_has_threads", lambda: threads)
    product.cache_clear()
    number = {"float": np.float32, "double": np.float64}[kind]
    random = np.random.default_rng(7)
    full = sp.triu(sp.random(ROWS, ROWS, 0.1, random_state=8) + sp.eye(ROWS)).tolil()
    first, middle = parts
    full[:first, middle:] = 0
    pattern = full.tocsr()
    blocks = random.normal(size=(pattern.nnz, 3, 3)).astype(number)
    blocks[pattern.indptr[:-1]] += blocks[pattern.indptr[:-1]].swapaxes(1, 2).copy()
    size = (3 * ROWS,) * 2
    upper = sp.bsr_matrix((blocks.astype(float), pattern.indices, pattern.indptr), size).toarray()
    own = sp.block_diag(blocks[pattern.indptr[:-1]].astype(float)).toarray()
    field, total = random.normal(size=(2, 3 * ROWS, width)).astype(number)
    given = [
        pattern.indptr.astype(np.int32),
        pattern.indices.astype(np.int32),
        blocks,
        guarded(field),
        guarded(total),
    ]
    product(width, kind)(*parts, ROWS, FACTOR, *(array.ctypes.data for array in given))
    expected = total + FACTOR * (upper + upper.T - own) @ field
    found = given[-1][: total.size].reshape(total.shape)
    assert np.abs(found - expected).max() < 100 * np.finfo(number).eps * np.abs(expected).max()
    assert np.isnan(given[-1][total.size :]).all()
