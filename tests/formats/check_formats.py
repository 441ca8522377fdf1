# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames in all formats against the CSV, number for number, by an independent reader.

check_formats.py READER PROGRAM SCENES WORK, where READER is
  own  no library: the lists of files, the text of XYZ, and a run that is killed and resumed
  vtk  VTK's own reader of .vtp
  ase  ASE's reader of extended XYZ
  h5py Python's reader of HDF5
Exit code 77: the reader is not installed.
"""

import csv
import math
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

SKIPPED = 77
READER, PROGRAM, SCENES, WORK = sys.argv[1:]


def run(scene, folder, *options):
    """Runs a scene into an empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run([PROGRAM, "run", os.path.join(SCENES, scene + ".toml"), "--out", folder,
                    *options], check=True, stdout=subprocess.DEVNULL)


def table(file):
    """The columns of a CSV file by name, without units."""
    with open(file, newline="") as lines:
        rows = list(csv.reader(lines))
    names = [name.split("[")[0] for name in rows[0]]
    columns = {name: [row[k] for row in rows[1:]] for k, name in enumerate(names)}
    return {name: values if name == "material" else [float(value) for value in values]
            for name, values in columns.items()}


def expect(same, what):
    if not same:
        raise SystemExit(f"{WORK}: {what}")


def vectors(grains, stem, dimension):
    """Three numbers for each grain; those that the plane has not are 0."""
    zeros = [0.0] * len(grains[stem + "x"])
    names = [stem + axis for axis in "xyz"[:dimension]]
    return list(zip(*[grains[name] for name in names], *[zeros] * (3 - dimension)))


def spins(grains, dimension):
    """None if nothing spins."""
    if dimension == 2 and "omega" in grains:
        return [(0.0, 0.0, omega) for omega in grains["omega"]]
    return vectors(grains, "omega_", 3) if "omega_x" in grains else None


def frames(folder):
    """Number and time of each frame."""
    listed = table(os.path.join(folder, "frames.csv"))
    expect(len(listed["frame"]) >= 4, "too few frames")
    return list(zip([f"{int(k):04d}" for k in listed["frame"]], listed["time"]))


def materials(folder):
    """Names in the order of the scene."""
    with open(os.path.join(folder, "scene.toml")) as text:
        heads = [line.strip()[len("[materials."):-1] for line in text
                 if line.startswith("[materials.")]
    return [head.strip('"') for head in heads]


def check_lists(folder):
    for kind in ("grains", "contacts", "walls", "edges", "cells"):
        listed = xml.parse(os.path.join(folder, "vtp", kind + ".pvd")).getroot()
        found = [(entry.get("file"), float(entry.get("timestep")))
                 for entry in listed.iter("DataSet")]
        expected = [(f"{kind}_{number}.vtp", t) for number, t in frames(folder)]
        expect(found == expected, f"{kind}.pvd lists {found}")


def check_xyz_text(folder, dimension):
    with open(os.path.join(folder, "frames.xyz")) as text:
        lines = text.read().splitlines()
    at = 0
    for number, t in frames(folder):
        grains = table(os.path.join(folder, "frames", number + ".csv"))
        count = int(lines[at])
        expect(count == len(grains["id"]), f"{count} grains in frame {number} of the XYZ")
        expect(f"Time={t!r} " in lines[at + 1] or f" Time={t:g} " in lines[at + 1],
               "time of the XYZ: " + lines[at + 1])
        numbers = [tuple(map(float, line.split(" "))) for line in lines[at + 2:at + 2 + count]]
        names = materials(folder)
        expected = [(i, names.index(m), *x, *v, r) for i, m, x, v, r in zip(
            grains["id"], grains["material"], vectors(grains, "", dimension),
            vectors(grains, "v", dimension), grains["radius"])]
        if spins(grains, dimension):
            expected = [(*row, *spin) for row, spin in zip(expected, spins(grains, dimension))]
        expect(numbers == expected, f"numbers of the XYZ in frame {number}")
        at += 2 + count
    expect(at == len(lines), "frames of the XYZ that are not listed")


def check_resumed(scene, whole):
    """A run that was killed at random moments and resumed leaves the same files."""
    folder = os.path.join(WORK, scene + "_killed")
    shutil.rmtree(folder, ignore_errors=True)
    command = [PROGRAM, "run", os.path.join(SCENES, scene + ".toml"), "--out", folder,
               "--checkpoint-every", "0 s"]
    for attempt in range(200):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if attempt < 12:
            time.sleep(random.uniform(0.02, 0.3))
            process.send_signal(signal.SIGKILL)
        if process.wait() == 0:
            break
        if os.path.exists(os.path.join(folder, "checkpoint.h5")):
            command = [PROGRAM, "resume", folder, "--checkpoint-every", "0 s"]
    for place, _, names in os.walk(whole):
        for name in names:
            if name.startswith(("checkpoint", "summary", "series")):
                continue  # these are compared elsewhere
            first = os.path.join(place, name)
            second = os.path.join(folder, os.path.relpath(first, whole))
            with open(first, "rb") as a, open(second, "rb") as b:
                expect(a.read() == b.read(), second + " differs after being killed and resumed")


def check_vtk(folder, dimension):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    def read(kind, number):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(os.path.join(folder, "vtp", f"{kind}_{number}.vtp"))
        reader.Update()
        return reader.GetOutput()

    def numbers(data, name):
        values = vtk_to_numpy(data.GetArray(name)).tolist()
        return [tuple(value) for value in values] if values and isinstance(values[0], list) \
            else values

    for number, t in frames(folder):
        grains = table(os.path.join(folder, "frames", number + ".csv"))
        contacts = table(os.path.join(folder, "contacts", number + ".csv"))
        mesh = read("grains", number)
        data = mesh.GetPointData()
        expect(mesh.GetFieldData().GetArray("TimeValue").GetValue(0) == t, "time")
        count = len(grains["id"])
        expect(mesh.GetNumberOfPoints() == mesh.GetNumberOfVerts() == count, "points")
        places = [tuple(x) for x in vtk_to_numpy(mesh.GetPoints().GetData()).tolist()]
        expect(places == vectors(grains, "", dimension), "places")
        expect(numbers(data, "velocity") == vectors(grains, "v", dimension), "velocities")
        expect(numbers(data, "radius") == grains["radius"], "radii")
        expect(numbers(data, "id") == grains["id"], "ids")
        names = materials(folder)
        expect([names[k] for k in numbers(data, "material")] == grains["material"], "materials")
        if spins(grains, dimension):
            expect(numbers(data, "spin") == spins(grains, dimension), "spins")
        coordination = {i: 0 for i in grains["id"]}
        for i, j in zip(contacts["i"], contacts["j"]):
            coordination[i] += 1
            if j >= 0:
                coordination[j] += 1
        expect(numbers(data, "coordination") == list(coordination.values()), "coordination")

        mesh = read("contacts", number)
        data = mesh.GetCellData()
        expect(mesh.GetNumberOfLines() == len(contacts["i"]), "contacts")
        if contacts["i"]:
            for name in ("i", "j", "wall", "overlap"):
                expect(numbers(data, name) == contacts[name], name)
            expect(numbers(data, "force") == vectors(contacts, "f", dimension), "forces")
            first = dict(zip(grains["id"], vectors(grains, "", dimension)))
            for k, i in enumerate(contacts["i"]):
                expect(mesh.GetPoint(2 * k) == first[i], "end of a contact")
                if contacts["j"][k] >= 0:
                    expect(mesh.GetPoint(2 * k + 1) == first[contacts["j"][k]], "other end")

        mesh = read("walls", number)
        cells = mesh.GetNumberOfLines() if dimension == 2 else mesh.GetNumberOfPolys()
        walls = set(numbers(mesh.GetCellData(), "wall"))
        expect(cells >= len(walls) and cells == mesh.GetNumberOfCells(), "facets of walls")
        expected = set(range({2: 4, 3: 7}[dimension]))
        if dimension == 3 and t >= 0.015:
            expected.remove(0)  # the paddle is gone
        expect(walls == expected, f"walls {walls} at {t}")
        check_cells(read("edges", number), read("cells", number), grains, contacts, dimension)


def check_cells(edges, cells, grains, contacts, dimension):
    """Edges hold all contacts, cells fill their box, and the power of a cell's own grain is least
    at its corners."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    def numbers(mesh, name):
        return vtk_to_numpy(mesh.GetCellData().GetArray(name)).tolist()

    centre = dict(zip(grains["id"], vectors(grains, "", dimension)))
    radius = dict(zip(grains["id"], grains["radius"]))
    pairs = list(zip(numbers(edges, "i"), numbers(edges, "j")))
    expect(edges.GetNumberOfLines() == len(pairs) == len(set(pairs)), "edges")
    touching = {(i, j) for i, j in zip(contacts["i"], contacts["j"]) if j >= 0}
    expect(touching <= set(pairs), "contacts that are no edges")
    for k, (i, j) in enumerate(pairs):
        line = edges.GetCell(k)
        expect([line.GetPoints().GetPoint(end) for end in (0, 1)] == [centre[i], centre[j]], "ends")
        distance = math.dist(centre[i], centre[j])
        expect(abs(numbers(edges, "gap")[k] - (distance - radius[i] - radius[j])) < 1e-12, "gap")

    total = 0
    expect(cells.GetNumberOfPolys() == cells.GetNumberOfCells(), "cells")
    for k, i in enumerate(numbers(cells, "id")):
        face = cells.GetCell(k).GetPoints()
        corners = [face.GetPoint(c) for c in range(face.GetNumberOfPoints())]
        for corner in corners:
            powers = {j: math.dist(corner, centre[j]) ** 2 - radius[j] ** 2 for j in centre}
            expect(powers[i] < min(powers.values()) + 1e-9, f"a corner of the cell of grain {i}")
        for b, c in zip(corners[1:], corners[2:]):
            a = corners[0]
            if dimension == 2:
                total += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
            else:  # the tetrahedra from the origin
                total += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                          + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
    bounds = cells.GetBounds()
    whole = math.prod(bounds[2 * d + 1] - bounds[2 * d] for d in range(dimension))
    expect(abs(total / whole - 1) < 1e-9, f"cells fill {total} of {whole}")


def check_h5py(folder, dimension):
    import h5py
    names = materials(folder)
    for number, t in frames(folder):
        grains = table(os.path.join(folder, "frames", number + ".csv"))
        contacts = table(os.path.join(folder, "contacts", number + ".csv"))
        with h5py.File(os.path.join(folder, "hdf5", number + ".h5")) as file:
            def rows(name):
                values = file[name][()].tolist()
                return [tuple(v) + (0.0,) * (3 - len(v)) for v in values] \
                    if values and isinstance(values[0], list) else values

            expect(rows("time") == [t], "time")
            expect(rows("position") == vectors(grains, "", dimension), "places")
            expect(rows("velocity") == vectors(grains, "v", dimension), "velocities")
            expect(rows("radius") == grains["radius"] and rows("id") == grains["id"], "radii, ids")
            expect([names[k] for k in rows("material")] == grains["material"], "materials")
            expect(len(rows("group")) == len(grains["id"]), "groups")
            if spins(grains, dimension):
                rates = [spin[-1] for spin in spins(grains, dimension)]
                expect([spin[2 if dimension == 3 else 0] if isinstance(spin, tuple) else spin
                        for spin in rows("spin")] == rates, "spins")
            for name in ("i", "j", "wall", "overlap"):
                expect(rows("contacts/" + name) == contacts[name], name)
            if contacts["i"]:
                expect(rows("contacts/normal") == vectors(contacts, "n", dimension), "normals")
                expect(rows("contacts/force") == vectors(contacts, "f", dimension), "forces")


def check_ase(folder, dimension):
    import ase.io
    read = ase.io.read(os.path.join(folder, "frames.xyz"), index=":", format="extxyz")
    expect(len(read) == len(frames(folder)), "frames that ASE reads")
    for atoms, (number, t) in zip(read, frames(folder)):
        grains = table(os.path.join(folder, "frames", number + ".csv"))
        expect(atoms.info["Time"] == t, "time that ASE reads")
        expect([tuple(x) for x in atoms.positions] == vectors(grains, "", dimension), "places")
        expect([tuple(v) for v in atoms.arrays["velo"]] == vectors(grains, "v", dimension),
               "velocities")
        for name in ("radius", "id"):
            expect(list(atoms.arrays[name]) == grains[name], name)
        names = materials(folder)
        expect([names[k] for k in atoms.arrays["material"]] == grains["material"], "materials")


if READER == "vtk":
    try:
        import vtkmodules.vtkIOXML  # noqa: F401
    except ImportError:
        print("SKIPPED: python3-vtk9 is not installed")
        sys.exit(SKIPPED)
if READER == "ase":
    try:
        import ase.io  # noqa: F401
    except ImportError:
        print("SKIPPED: python3-ase is not installed")
        sys.exit(SKIPPED)
if READER == "h5py":
    try:
        import h5py  # noqa: F401
    except ImportError:
        print("SKIPPED: python3-h5py is not installed")
        sys.exit(SKIPPED)

for scene, dimension in (("plane", 2), ("space", 3)):
    folder = os.path.join(WORK, scene)
    run(scene, folder)
    if READER == "own":
        check_lists(folder)
        check_xyz_text(folder, dimension)
        check_resumed(scene, folder)
    elif READER == "vtk":
        check_vtk(folder, dimension)
    elif READER == "h5py":
        check_h5py(folder, dimension)
    else:
        check_ase(folder, dimension)
print(f"{READER}: the same numbers")
