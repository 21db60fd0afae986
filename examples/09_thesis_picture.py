"""A picture for a thesis: the optimised web from the run's web.stl, shaded, in the size of a column."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import trimesh
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from cranktopo import load_scene, optimise_design

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
run = out / "run"
if not run.is_dir():
    optimise_design(load_scene("mikron-iiic").with_optimise(resolution_mm=4.5, max_iterations=12), out=run)

mesh = trimesh.load_mesh(run / "web.stl")
figure = plt.figure(figsize=(4, 4))
axes = figure.add_axes((0, 0, 1, 1), projection="3d", proj_type="ortho")
corners = mesh.triangles[:, :, [0, 2, 1]]  # x, z, y: the throw stands upright
axes.add_collection3d(Poly3DCollection(corners, facecolors="#b9c4cf", shade=True))
low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
axes.set_box_aspect(high - low, zoom=1.2)
axes.view_init(elev=20, azim=-50)
axes.set_axis_off()
figure.savefig(out / "09_thesis_picture.png", dpi=120)
