"""The largest readings of pressure sensors in one run or several, each with what came before and after it, and a picture.

usage: largest_readings.py RUN-FOLDER... [--count 10] [--pictures FOLDER] [--reach METRES]        (needs pandas, vtk, matplotlib)

Of one sensor, readings nearer than 10 ms to a larger one do not count again. Pictures show the particles about the sensor one frame
before, at and after the reading, so that the run needs frames as dense as that (`--set output.interval=0.001`).
"""

import argparse
from pathlib import Path
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pandas as pd
from results_with_pandas import read
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

APART = 0.01
MEDIAN_OF = 21


def largest(series, count):
    """Times of the largest values of a series by time, the largest first."""
    left, times = series.copy(), []
    while len(times) < count and left.max() > 0.0:
        times.append(left.idxmax())
        left[(left.index > times[-1] - APART) & (left.index < times[-1] + APART)] = 0.0
    return times


def readings(folder, count):
    """The largest readings of a run: one row for each."""
    table, _ = read(folder)
    rows = []
    for name in table.columns:
        if not (name.startswith("fluid.probe.") and name.endswith(".pressure")):
            continue
        series = table[name]
        median = series.rolling(MEDIAN_OF, center=True, min_periods=1).median()
        for time in largest(series, count):
            at = series.index.get_loc(time)
            before, after = (series.iloc[k] if 0 <= k < len(series) else np.nan for k in (at - 1, at + 1))
            sensor = name.removeprefix("fluid.probe.").removesuffix(".pressure")
            usual = median[time] if median[time] > 0.0 else np.nan
            row = {"reading [Pa]": series[time], "time [s]": time, "sensor": sensor, "before": before, "after": after}
            rows.append({**row, "over median": series[time] / usual, "run": str(folder)})
    return rows


def place(folder, sensor):
    """Where a sensor of a scene is; none for one of a body, which moves, and for one of a row of sensors."""
    scene = tomllib.loads((Path(folder) / "scene.toml").read_text(encoding="utf-8"))
    for probe in scene["fluid"].get("probe", []):
        same = probe["name"].replace(" ", "_").lower() in sensor.lower()
        if same and "point" in probe and "on_body" not in probe:
            return np.array(probe["point"]), scene["fluid"]["spacing"]
    return None


def draw(row, reach, path):
    """The particles about a sensor one frame before, at and after a reading."""
    found = place(row["run"], row["sensor"])
    grids = frames(row["run"])
    if found is None or len(grids) < 3:
        return False
    (x, y), spacing = found
    reach = reach or 15 * spacing
    at = int(np.argmin([abs(time - row["time [s]"]) for _, time in grids]))
    at = min(max(at, 1), len(grids) - 2)
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.6), sharey=True, layout="constrained")
    for axis, (frame, time) in zip(axes, grids[at - 1 : at + 2]):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(frame))
        reader.Update()
        points = vtk_to_numpy(reader.GetOutput().GetPoints().GetData())
        pressure = vtk_to_numpy(reader.GetOutput().GetPointData().GetArray("pressure"))
        near = (abs(points[:, 0] - x) < reach) & (abs(points[:, 1] - y) < reach)
        size = (0.9 * spacing / reach * 150) ** 2
        drawn = axis.scatter(points[near, 0], points[near, 1], c=pressure[near] / 1e3, s=size, vmin=0, vmax=row["reading [Pa]"] / 1e3)
        axis.plot([x], [y], "r+", markersize=12)
        axis.set(aspect="equal", title=f"t = {time:.4f} s", xlim=(x - reach, x + 3 * spacing), ylim=(y - 4 * spacing, y + reach))
    figure.colorbar(drawn, ax=axes, label="p [kPa]")
    figure.suptitle(f"{row['sensor']}: {row['reading [Pa]'] / 1e3:.1f} kPa at {row['time [s]']:.4f} s")
    figure.savefig(path, dpi=80)
    plt.close(figure)
    return True


def frames(folder):
    """Frames of the particles with their times, from the list that ParaView opens."""
    listing = Path(folder) / "frames" / "particles.pvd"
    entries = ElementTree.parse(listing).iter("DataSet") if listing.exists() else []
    return [(listing.parent / entry.get("file"), float(entry.get("timestep"))) for entry in entries]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--pictures", type=Path)
    parser.add_argument("--reach", type=float)
    arguments = parser.parse_args()
    rows = [row for folder in arguments.folders for row in readings(folder, arguments.count)]
    rows = sorted(rows, key=lambda row: -row["reading [Pa]"])[: arguments.count]
    print(pd.DataFrame(rows, index=range(1, len(rows) + 1)).round(5).to_string())
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
        drawn = sum(draw(row, arguments.reach, arguments.pictures / f"reading-{k + 1:02}.png") for k, row in enumerate(rows))
        print(f"{drawn} pictures in {arguments.pictures}")


if __name__ == "__main__":
    main()
