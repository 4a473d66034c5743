#!/usr/bin/env python3
"""Reads paths.npz (output.npz) and draws a link's power delay profile and its power over time.

python3 read_paths.py out/town_drive/paths.npz [TX RX [PICTURE.png]]"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

file, tx, rx, picture = (sys.argv[1:] + [None] * 4)[:4]
paths = np.load(file)
t = list(paths["tx_id"]).index(tx) if tx else 0
r = list(paths["rx_id"]).index(rx) if rx else 0
valid = paths["valid"][:, r, t]  # [frame, path]; shorter lists are padded with False
delay_ns = 1e9 * paths["tau"][:, r, t]
# Relative to the transmitted power. Between VH antennas there is no `a` (NaN): take `transfer` instead.
gain = np.where(valid, np.abs(paths["a"][:, r, t]) ** 2, 0.0)

time_s = np.broadcast_to(paths["time_s"][:, None], gain.shape)
seen = valid & (gain > 0)
_, (profile, power) = plt.subplots(2, 1, sharex=True, figsize=(9, 7), layout="constrained")
dots = profile.scatter(time_s[seen], delay_ns[seen], c=10 * np.log10(gain[seen]), s=6)
plt.colorbar(dots, ax=profile, label="path gain (dB)")
profile.set(ylabel="delay (ns)", title=f"{paths['tx_id'][t]} to {paths['rx_id'][r]}")
total = gain.sum(axis=1)
coherent = np.abs(np.where(valid, paths["a"][:, r, t], 0.0).sum(axis=1)) ** 2
for name, values in (("coherent", coherent), ("incoherent", total)):
    power.plot(paths["time_s"], 10 * np.log10(np.where(values > 0, values, np.nan)), label=name)
power.set(xlabel="time (s)", ylabel="path gain (dB)")
power.legend()
plt.savefig(picture or "paths.png", dpi=110)
print(f"{valid.shape[0]} frames, {valid.sum()} paths, at most {valid.sum(axis=1).max()} in a frame")
