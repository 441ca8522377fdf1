# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's first figure, and a work-precision plot, from Python: example.py [PICTURE.png]

Cell by cell this can be pasted into a notebook.
"""

# %% What is needed. The folder of the module has to be in PYTHONPATH.
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection

import lagrain

# %% 24 discs come to rest in a box.
SCENE = """
dimension = 2
duration = "2 s"
seed = 3
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
[law]
stiffness = "1e7 N/m"
restitution = 0.3
friction = 0.5
[materials.stone]
density = 2500
[[fill]]
count = 24
radius = { uniform = ["40 mm", "90 mm"] }
region = { low = [0, 0], high = [0.8, 1.6] }
[[box]]
low = [0, 0]
high = [0.8, 2]
open = ["top"]
"""
bed = lagrain.Simulation2(SCENE)
bed.step(round(bed.duration / bed.time_step))
positions, radii = bed.positions, bed.radii

# %% Their triangulation, its cells, and which edges are contacts.
t = lagrain.Triangulation2(positions, radii)
high = positions[:, 1].max() + 0.12
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.6))
for i in range(len(t)):
    cell = t.cell(i, (0, 0), (0.8, high))
    if len(cell):
        left.fill(*cell.T, facecolor="#faf7ee", edgecolor="#c49a48", linewidth=0.8)
left.add_collection(EllipseCollection(
    2 * radii, 2 * radii, 0 * radii, units="xy", offsets=positions, transOffset=left.transData,
    facecolor="#d6dfe8", edgecolor="#3e546b"))
left.add_collection(LineCollection(positions[t.edges], colors="#6e6e6e", linewidths=0.8))
contacts = bed.contacts
pairs = contacts["wall"] < 0
ends = np.stack([contacts["i"][pairs], contacts["j"][pairs]], axis=1)
force = np.linalg.norm(contacts["force"][pairs], axis=1)
left.add_collection(LineCollection(positions[ends], colors="#961c22",
                                   linewidths=0.5 + 1.5 * force / force.mean()))
left.set(xlim=(0, 0.8), ylim=(0, high), aspect="equal", xticks=[], yticks=[])
left.set_title(f"{len(t.edges)} edges, {pairs.sum()} of them contacts")
assert {tuple(sorted(pair)) for pair in ends} <= {tuple(edge) for edge in t.edges}

# %% How wrong a bounce is, against what it costs: speed and error belong together.
BOUNCE = """
dimension = 2
duration = 1
gravity = [0, 0]
integrator = "{integrator}"
time_step = "1/{steps} contact"
normal = "linear"
friction = "none"
[law]
stiffness = 1e5
restitution = 0.5
[materials.stone]
density = 2500
[[grain]]
position = [0, {height}]
radius = 0.05
velocity = [0, -1]
[[wall]]
name = "floor"
point = [0, 0]
normal = [0, 1]
"""


def error_of_bounce(integrator, steps):
    """Root mean square over where in a step the touch begins."""
    errors = []
    for height in np.linspace(0.0501, 0.0502, 7):
        ball = lagrain.Simulation2(BOUNCE.format(integrator=integrator, steps=steps,
                                                 height=height))
        while not (ball.velocities[0, 1] > 0 and len(ball.contacts["i"]) == 0):
            ball.step()
        errors.append(ball.velocities[0, 1] / 0.5 - 1)
    return np.sqrt(np.mean(np.square(errors)))


STEPS = np.unique(np.geomspace(12, 500, 14).astype(int))
for integrator, mark in (("symplectic Euler", "o--"), ("velocity Verlet", "s-")):
    right.loglog(STEPS, [error_of_bounce(integrator, k) for k in STEPS], mark, markersize=4,
                 label=integrator)
right.set(xlabel="steps in a contact, each one evaluation of the force",
          ylabel="relative error of the speed", title="a bounce with restitution 0.5")
right.legend()

# %%
figure.tight_layout()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "example.png", dpi=120)
