"""The cantilever of `tests.studies.cantilever` in pyMOTO: multigrid CG, density filter, its own OC.

Runs in the peers' environment, without cranktopo: `python with_pymoto.py NX NY NZ ITERATIONS DENSITY.npy`.
Set up as its multigrid example does: three levels, the coarsest factorised, residual 1e-5.
"""

import json
import resource
import sys
import time

import numpy as np
import pymoto as pym

LEVELS = 3


def main() -> None:
    """Save the last physical density [x, y, z]; print seconds of every iteration and peak memory as JSON."""
    nx, ny, nz, iterations = (int(a) for a in sys.argv[1:5])
    domain = pym.VoxelDomain(nx, ny, nz)
    fixed = domain.get_dofnumber(domain.get_nodenumber(*np.meshgrid(0, range(ny + 1), range(nz + 1))), ndof=3)
    loaded = domain.get_nodenumber(nx, np.arange(ny + 1), 0)
    force = np.zeros(3 * domain.nnodes)
    force[3 * loaded + 2] = -1.0

    x = pym.Signal("x", state=np.full(domain.nel, 0.3))
    with pym.Network() as network:
        density = pym.DensityFilter(domain, radius=1.5)(x)
        moduli = pym.MathExpression("1e-9 + (1 - 1e-9) * inp0^3")(density)
        stiffness = pym.AssembleStiffness(domain, poisson_ratio=0.3, bc=fixed.flatten())(moduli)
        solver = pym.solvers.CG(preconditioner=multigrid(domain), tol=1e-5)
        u = pym.LinSolve(hermitian=True, symmetric=True, positive_definite=True, solver=solver)(
            stiffness, force
        )
        compliance = pym.EinSum("i,i->")(u, force)

    optimiser = pym.OC(x, compliance, network, move=0.2, xmin=0.0, maxvol=0.3, l2init=1e9, verbosity=0)
    seconds, design = [], x.state
    for _ in range(iterations):
        began = time.perf_counter()
        design, _, _ = optimiser.step(design)
        seconds.append(time.perf_counter() - began)
    physical = pym.DensityFilter(domain, radius=1.5)(pym.Signal("design", state=design)).state
    elements = domain.get_elemnumber(*np.meshgrid(range(nx), range(ny), range(nz), indexing="ij"))
    np.save(sys.argv[5], physical[elements])
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"seconds": seconds, "peak_MiB": peak}))


def multigrid(domain: pym.VoxelDomain) -> pym.solvers.Preconditioner:
    """Nested V-cycles; the last level is factorised."""
    finest = pym.solvers.GeometricMultigrid(domain)
    level = finest
    for _ in range(LEVELS - 2):
        level.inner_level = pym.solvers.GeometricMultigrid(level.sub_domain)
        level = level.inner_level
    return finest


if __name__ == "__main__":
    main()
