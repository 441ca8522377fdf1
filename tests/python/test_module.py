# SPDX-License-Identifier: GPL-3.0-or-later
"""The module for Python: test_module.py FOLDER EXAMPLE, where FOLDER holds the module."""

import gc
import os
import runpy
import sys
import threading
import unittest
from fractions import Fraction

import numpy as np

FOLDER, EXAMPLE = sys.argv[1:3]
sys.path.insert(0, FOLDER)
import lagrain  # noqa: E402

SCENE = """
dimension = 2
duration = 1
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
[law]
stiffness = 1e6
restitution = 0.5
friction = 0.4
[materials.rock]
density = 2650
[[fill]]
count = 60
radius = { uniform = ["8 mm", "10 mm"] }
region = { low = [0, 0], high = [0.2, 0.4] }
[[box]]
low = [0, 0]
high = [0.2, 1]
open = ["top"]
"""


def in_space(scene):
    return (scene.replace("dimension = 2", "dimension = 3").replace("[0, -9.81]", "[0, 0, -9.81]")
            .replace("low = [0, 0]", "low = [0, 0, 0]").replace("[0.2, 0.4]", "[0.2, 0.2, 0.4]")
            .replace("[0.2, 1]", "[0.2, 0.2, 1]"))


def power_edges(centres, radii):
    """Edges of the regular triangulation in the plane by brute force, in exact arithmetic: a
    triangle is there if no other site has less power at the centre of its orthogonal circle."""
    points = [[Fraction(v) for v in row] for row in centres]
    heights = [x * x + y * y - Fraction(r) ** 2 for (x, y), r in zip(points, radii)]
    edges, n = set(), len(points)
    for a in range(n):
        for b in range(a + 1, n):
            for c in range(b + 1, n):
                rows = [[points[i][0] - points[a][0], points[i][1] - points[a][1],
                         heights[i] - heights[a]] for i in (b, c)]
                turn = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
                if turn == 0:
                    continue
                # The plane through the three lifted sites: height = slope . place.
                sx = (rows[0][2] * rows[1][1] - rows[1][2] * rows[0][1]) / turn
                sy = (rows[0][0] * rows[1][2] - rows[1][0] * rows[0][2]) / turn
                if all(heights[d] - heights[a] > sx * (points[d][0] - points[a][0]) +
                       sy * (points[d][1] - points[a][1])
                       for d in range(n) if d not in (a, b, c)):
                    edges |= {(a, b), (a, c), (b, c)}
    return sorted(edges)


class Triangulations(unittest.TestCase):
    def setUp(self):
        self.random = np.random.default_rng(1)

    def sites(self, count, dimension):
        return self.random.random((count, dimension)), self.random.uniform(0.02, 0.15, count)

    def test_edges_are_those_of_brute_force(self):
        for _ in range(5):
            centres, radii = self.sites(14, 2)
            t = lagrain.Triangulation2(centres, radii)
            self.assertEqual([tuple(edge) for edge in t.edges], power_edges(centres, radii))
            self.assertEqual(t.audit(), [])
            self.assertEqual(len(t), 14)

    def test_moved_sites_give_what_is_built_anew(self):
        for dimension, make in ((2, lagrain.Triangulation2), (3, lagrain.Triangulation3)):
            centres, radii = self.sites(60, dimension)
            t = make(centres, radii)
            moved = centres + self.random.uniform(-0.05, 0.05, centres.shape)
            self.assertGreater(t.move(moved, radii), 0)
            np.testing.assert_array_equal(t.edges, make(moved, radii).edges)
            self.assertEqual(t.audit(), [])
            self.assertEqual(t.edges.shape[1], 2)

    def test_cells_fill_their_box(self):
        centres, radii = self.sites(30, 2)
        t = lagrain.Triangulation2(centres, radii)
        area = 0
        for i in range(30):
            x, y = t.cell(i, (0, 0), (1, 1)).T
            area += 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        self.assertLess(abs(area - 1), 1e-12)
        centres, radii = self.sites(20, 3)
        t = lagrain.Triangulation3(centres, radii)
        volume = 0
        for i in range(20):
            for beyond, corners in t.cell(i, (0, 0, 0), (1, 1, 1)):
                self.assertTrue(-6 <= beyond < 20)
                for b, c in zip(corners[1:], corners[2:]):
                    volume += np.dot(corners[0], np.cross(b, c)) / 6
        self.assertLess(abs(volume - 1), 1e-12)
        self.assertEqual(t.tetrahedra.shape[1], 4)

    def test_bad_inputs_are_value_errors_of_one_sentence(self):
        centres, radii = self.sites(10, 2)
        t = lagrain.Triangulation2(centres, radii)
        for bad in (lambda: lagrain.Triangulation2(centres, radii[:3]),
                    lambda: lagrain.Triangulation2(centres[:, :1], radii),
                    lambda: lagrain.Triangulation2(centres * np.nan, radii),
                    lambda: t.move(centres[:4], radii[:4]), lambda: t.cell(10, (0, 0), (1, 1)),
                    lambda: t.cell(-1, (0, 0), (1, 1)), lambda: t.cell(0, (0, 0), (0, 1))):
            with self.assertRaises(ValueError) as caught:
                bad()
            self.assertNotIn("\n", str(caught.exception))
        self.assertEqual(t.audit(), [])


class Simulations(unittest.TestCase):
    def simulations(self):
        return (2, lagrain.Simulation2(SCENE)), (3, lagrain.Simulation3(in_space(SCENE)))

    def test_grains_fall_and_touch(self):
        for dimension, simulation in self.simulations():
            self.assertEqual(simulation.positions.shape, (60, dimension))
            self.assertEqual(len(simulation), 60)
            top = simulation.positions[:, -1].max()
            simulation.step(12000)
            self.assertGreater(simulation.time, 0.99 * 12000 * simulation.time_step)
            self.assertLess(simulation.positions[:, -1].max(), top)
            contacts = simulation.contacts
            self.assertGreater(len(contacts["i"]), 20)
            self.assertEqual(contacts["force"].shape, (len(contacts["i"]), dimension))
            pairs = contacts["wall"] < 0
            i, j = contacts["i"][pairs], contacts["j"][pairs]
            distance = np.linalg.norm(simulation.positions[i] - simulation.positions[j], axis=1)
            overlap = simulation.radii[i] + simulation.radii[j] - distance
            np.testing.assert_allclose(overlap, contacts["overlap"][pairs], atol=1e-15)
            ledger = simulation.ledger
            self.assertLess(abs(ledger["residual"]), 0.01 * abs(ledger["gravity"]))
            self.assertIn("time step", simulation.explain())

    def test_arrays_are_views_that_live_as_long_as_they_are_held(self):
        for _, simulation in self.simulations():
            positions = simulation.positions
            self.assertFalse(positions.flags.writeable or positions.flags.owndata)
            with self.assertRaises(ValueError):
                positions[0] = 0
            before = positions.copy()
            simulation.step(100)
            now = simulation.positions
            self.assertTrue(np.shares_memory(positions, now))
            self.assertFalse(np.array_equal(before, now))
            wanted = now.copy()
            del simulation, now
            gc.collect()
            np.testing.assert_array_equal(positions, wanted)

    def test_copies_where_grains_come_and_leave(self):
        inlet = SCENE + """
[[inlet]]
material = "rock"
radius = "5 mm"
region = { low = [0.02, 0.6], high = [0.18, 0.9] }
rate = 2000
"""
        simulation = lagrain.Simulation2(inlet)
        positions = simulation.positions
        self.assertTrue(positions.flags.owndata)
        simulation.step(2000)
        self.assertGreater(len(simulation), 60)
        self.assertEqual(positions.shape, (60, 2))
        self.assertEqual(len(simulation.ids), len(simulation))

    def test_settings_and_threads_change_what_they_should(self):
        smooth = lagrain.Simulation2(SCENE, ["law.friction=0"], threads=2)
        rough, again = lagrain.Simulation2(SCENE), lagrain.Simulation2(SCENE, threads=2)
        for simulation in (smooth, rough, again):
            simulation.step(2000)
        self.assertFalse(np.array_equal(smooth.positions, rough.positions))
        np.testing.assert_array_equal(rough.positions, again.positions)

    def test_errors_are_value_errors(self):
        for scene, words in ((SCENE.replace("stiffness", "stifness"), "stiffness"),
                             ("dimension = 3", "dimension"), ("=", "scene")):
            with self.assertRaises(ValueError) as caught:
                lagrain.Simulation2(scene)
            self.assertIn(words, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
        bullet = SCENE.replace("[[box]]", """[[grain]]
position = [0.1, 0.8]
radius = 0.01
material = "rock"
velocity = [0, -900]
[[box]]""")
        simulation = lagrain.Simulation2(bullet)
        with self.assertRaises(lagrain.SimulationError) as caught:
            simulation.step(100000)
        self.assertIsInstance(caught.exception, ValueError)
        with self.assertRaises(ValueError):
            lagrain.Simulation2(SCENE).step(-1)

    def test_other_threads_run_while_it_steps(self):
        simulation, beats, end = lagrain.Simulation2(SCENE), [], threading.Event()

        def beat():
            while not end.is_set():
                beats.append(simulation)
                end.wait(0.001)

        other = threading.Thread(target=beat)
        other.start()
        before = len(beats)
        simulation.step(20000)
        during = len(beats) - before
        end.set()
        other.join()
        self.assertGreater(during, 3)

    def test_the_example_runs(self):
        import matplotlib
        matplotlib.use("Agg")
        picture = os.path.join(FOLDER, "example.png")
        sys.argv = [EXAMPLE, picture]
        runpy.run_path(EXAMPLE, run_name="__main__")
        self.assertGreater(os.path.getsize(picture), 10000)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
