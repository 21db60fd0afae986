"""A picture for a thesis: the optimised web from the run's web.stl, shaded, in the size of a column."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import trimesh
from matplotlib.colors import LightSource
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from cranktopo import load_scene, optimise_design

out = Path(sys.argv[1] if sys.argv[1:] else "examples/out")
run = out / "run"
if not run.is_dir():
    optimise_design(load_scene("mikron-iiic").with_optimise(resolution_mm=4.5, max_iterations=20), out=run)

mesh = trimesh.load_mesh(run / "web.stl").subdivide_to_size(3.0)  # small faces hide each other rightly
figure = plt.figure(figsize=(4, 4))
axes = figure.add_axes((0, 0, 1, 1), projection="3d", proj_type="ortho")
corners = mesh.triangles[:, :, [0, 2, 1]] * (1, -1, 1)  # the throw stands upright, the crankpin is in front
light = LightSource(azdeg=200, altdeg=40)
smooth = {"shade": True, "lightsource": light, "linewidth": 0, "antialiased": False}
axes.add_collection3d(Poly3DCollection(corners, facecolors="#c3ced9", **smooth))
low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
axes.set_box_aspect(high - low, zoom=1.35)
axes.view_init(elev=20, azim=-60)
axes.set_axis_off()
figure.savefig(out / "09_thesis_picture.png", dpi=120)
