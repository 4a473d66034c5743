#!/usr/bin/env python3
"""Reads a map's arrays (map_<grid>_<tx>.npz of `dcem map`) and draws one of them.

python3 read_map.py out/office_map/map_floor_corridor.npz [power_incoherent_dbm [PICTURE.png]]"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

file, name, picture = (sys.argv[1:] + [None] * 3)[:3]
name = name or "power_incoherent_dbm"
grid = np.load(file)  # arrays over [row, column]; NaN where a point has no value
figure, axes = plt.subplots(figsize=(9, 6), layout="constrained")
mesh = axes.pcolormesh(grid["x_m"], grid["y_m"], grid[name], shading="nearest")
figure.colorbar(mesh, label=name)
# Maps over all transmitters (best server, SINR) say nothing of a frequency.
title = f"{name} at {grid['frequency_hz'] / 1e9:g} GHz" if "frequency_hz" in grid else name
axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", title=title)
plt.savefig(picture or "map.png", dpi=110)
values = grid[name][np.isfinite(grid[name])]
if values.size:
    print(f"{values.size} points, median {np.median(values):.1f}, {values.min():.1f} to {values.max():.1f}")
