"""Reads the field frames of a short coupled run with VTK's own readers, which are those of ParaView.

    python check_frames.py PLIMSOLL

Every file of the folder is listed and whole, times are those of the interval, arrays have the right names, lengths and
kinds, all numbers are finite, and places agree with the scene, the results and the summary of the same run.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_LINE, VTK_VERTEX
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
SCENE = "dam_break_plate"
SPACING, END, INTERVAL = 0.008, 0.2, 0.02
# Components of the fields of each series.
PARTICLES = {"pressure": 1, "velocity": 3, "number_density": 1, "surface": 1}
STRUCTURE = {"displacement": 3}


class Grid:
    """One .vtu file as arrays."""

    def __init__(self, path):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(path))
        errors = []
        reader.AddObserver("ErrorEvent", lambda *_: errors.append(path.name))
        reader.Update()
        grid = reader.GetOutput()
        self.readable = not errors and bool(reader.CanReadFile(str(path))) and grid.GetNumberOfPoints() > 0
        if not self.readable:
            return
        self.points = vtk_to_numpy(grid.GetPoints().GetData())
        self.kinds = [grid.GetCellType(cell) for cell in range(grid.GetNumberOfCells())]
        self.cells = [
            [grid.GetCell(cell).GetPointId(k) for k in range(grid.GetCell(cell).GetNumberOfPoints())]
            for cell in range(grid.GetNumberOfCells())
        ]
        data = grid.GetPointData()
        self.fields = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}

    def has(self, expected):
        """Whether these fields are there, with one finite entry per point, and no others."""
        shapes = {
            name: (len(self.points),) if size == 1 else (len(self.points), size) for name, size in expected.items()
        }
        same = {name: values.shape for name, values in self.fields.items()} == shapes
        return same and all(np.isfinite(values).all() for values in [self.points, *self.fields.values()])


def read_series(path):
    """Times and grids of a .pvd file, and the names of the files that it lists."""
    entries = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    names = [entry.get("file") for entry in entries]
    return (
        np.array([float(entry.get("timestep")) for entry in entries]),
        [Grid(path.parent / it) for it in names],
        names,
    )


def read_results(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = np.array([[float(entry) for entry in row] for row in rows[1:]])
    return {name.split(" [")[0]: values[:, k] for k, name in enumerate(rows[0])}


def run(program, out):
    values = {"fluid.spacing": SPACING, "run.end": END, "output.interval": INTERVAL}
    changes = [word for key, value in values.items() for word in ("--set", f"{key}={value}")]
    done = subprocess.run([program, "run", SCENE, *changes, "--quiet", "--out", out], check=False, timeout=300)
    # 3: at its end, but outside a limit of the scene, which is changed here.
    assert done.returncode in (0, 3), done.returncode


def check_times(name, times):
    expected = INTERVAL * np.arange(round(END / INTERVAL) + 1)
    even = len(times) == len(expected) and np.allclose(times, expected, rtol=0.0, atol=1e-9)
    return {f"{name}: {len(times)} frames at {INTERVAL} s each": even and bool((np.diff(times) > 0.0).all())}


def check_particles(times, grids, scene, results, summary):
    wall = np.array(scene["fluid"]["wall"][0]["points"])
    low, high = wall.min(axis=0), wall.max(axis=0)
    inside = [((it.points[:, :2] > low) & (it.points[:, :2] < high)).all() for it in grids]
    kinds = [it.kinds == [VTK_VERTEX] * len(it.points) and len(np.unique(it.cells)) == len(it.points) for it in grids]
    counts = [len(it.points) for it in grids]
    recorded = np.interp(times, results["time"], results["fluid.particles.count"])
    centres = np.array([it.points[:, 0].mean() for it in grids])
    apart = np.abs(centres - np.interp(times, results["time"], results["fluid.centre.x"])).max()
    speeds = np.array([np.abs(it.fields["velocity"]).max() for it in grids])
    return {
        f"particles: {min(counts)} to {max(counts)} points, each a cell": all(kinds),
        "particles: pressure, velocity, number density and surface of each": all(it.has(PARTICLES) for it in grids),
        "particles: as many as in the results and the summary": counts == list(recorded)
        and counts[-1] == summary["particles"],
        "particles: all within the tank": all(inside),
        "particles: all in one plane": all(
            not it.points[:, 2].any() and not it.fields["velocity"][:, 2].any() for it in grids
        ),
        # Nothing is computed yet in the first frame.
        "particles: the surface is marked by 0 and 1": all(set(it.fields["surface"]) == {0, 1} for it in grids[1:]),
        f"particles: at rest, then up to {speeds.max():.2f} m/s": speeds[0] == 0.0 and 1.0 < speeds.max() < 5.0,
        f"particles: their centre is that of the results within {apart:.1e} m": apart < 1e-6,
    }


def check_structure(times, grids, scene, results):
    beam = scene["body"][0]["member"][0]
    foot = beam["middle"][1] - 0.5 * beam["length"]
    rest = grids[0].points
    tops = [it.points[:, 1].argmax() for it in grids]
    tips = np.array([it.fields["displacement"][top, 0] for it, top in zip(grids, tops)])
    apart = np.abs(tips - np.interp(times, results["time"], results["structure.body.base.plate.deflection.tip"])).max()
    moved = [np.abs(it.points - it.fields["displacement"] - rest).max() for it in grids]
    lines = [it.kinds == [VTK_LINE] * (len(it.points) // 2) for it in grids]
    return {
        f"structure: {len(rest)} points, joined by lines": all(lines) and len(rest) > 100,
        "structure: displacement of each": all(it.has(STRUCTURE) for it in grids),
        "structure: the outline of the scene's plate": np.isclose(np.ptp(rest[:, 0]), beam["thickness"], atol=1e-6)
        and np.isclose(np.ptp(rest[:, 1]), beam["length"], atol=1e-6)
        and np.isclose(rest[:, 1].min(), foot, atol=1e-6),
        "structure: points less displacement are the first outline": max(moved) < 1e-6,
        f"structure: swings to {1e3 * np.abs(tips).max():.1f} mm": np.abs(tips).max() > 5e-3
        and not grids[0].fields["displacement"].any(),
        f"structure: its tip is that of the results within {apart:.1e} m": apart < 1e-6,
    }


def check_walls(grid, scene):
    wall = np.array(scene["fluid"]["wall"][0]["points"])
    return {
        "walls: the scene's points": np.allclose(grid.points[:, :2], wall, atol=1e-6),
        "walls: joined one after the other": grid.cells == [[k, k + 1] for k in range(len(wall) - 1)],
    }


def check(out):
    scene = tomllib.loads((ROOT / "scenes" / f"{SCENE}.toml").read_text())
    results, summary = read_results(out / "results.csv"), json.loads((out / "summary.json").read_text())
    frames = out / "frames"
    times, particles, names = read_series(frames / "particles.pvd")
    plate_times, plates, plate_names = read_series(frames / "structure.pvd")
    walls = Grid(frames / "walls.vtu")
    known = {"walls.vtu", "particles.pvd", "structure.pvd", *names, *plate_names}
    checks = {
        "every file is listed, and every listed file is there": {it.name for it in frames.iterdir()} == known,
        "VTK reads every file": all(it.readable for it in [*particles, *plates, walls]),
    }
    if not all(checks.values()):
        return checks
    return {
        **checks,
        **check_times("particles", times),
        **check_times("structure", plate_times),
        **check_particles(times, particles, scene, results, summary),
        **check_structure(plate_times, plates, scene, results),
        **check_walls(walls, scene),
    }


def main():
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        run(sys.argv[1], out)
        checks = check(out)
    for what, passed in checks.items():
        print(f"{'ok  ' if passed else 'FAIL'} frames: {what}")
    failed = sum(not passed for passed in checks.values())
    print(f"{len(checks) - failed} passed, {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
