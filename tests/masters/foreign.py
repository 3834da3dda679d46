"""Couples FMUs made with other exporters in the bundled master.

    python foreign.py FOLDER PLIMSOLL

FOLDER holds fluid.fmu and structure.fmu, PLIMSOLL is the bundled program. The stranger is a mass on a spring made with
fmu_from_struct (tests/foreign; built here by cargo), which gives neither states nor derivatives:

- coupled to our fluid under ten times its mass of water, explicitly with the fluid's added mass: follows the exact swing;
- the same with `iqn_ils`: refused, with the reason and a way out;
- with `auto`: runs explicitly and says so;
- two strangers alone, a mass that pulls another;
- the container that fmucontainer makes of both our FMUs, as one stranger.
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

SAG = 0.2484902029
ROOT = Path(__file__).resolve().parents[2]


def build(folder):
    target = ROOT / "target" / "foreign"
    environment = {**os.environ, "CARGO_TARGET_DIR": str(target)}
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=ROOT / "tests" / "foreign", env=environment, check=True)
    archive = folder / "spring_mass.fmu"
    description = target / "fmu" / "spring_mass" / "modelDescription.xml"
    identifier = description.read_text().split('modelIdentifier="')[1].split('"')[0]
    with zipfile.ZipFile(archive, "w") as packed:
        packed.write(description, "modelDescription.xml")
        packed.write(target / "release" / "libspring_mass.so", f"binaries/linux64/{identifier}.so")
    return archive


def case(folder, name, fmus, connections, method="explicit", end=1.0, step=0.002):
    lines = [f'title = "{name}"', "[run]", f"end = {end}", f"communication_step = {step}"]
    for fmu, (path, parameters) in fmus.items():
        lines += ["[[fmu]]", f'name = "{fmu}"', f'path = "{path}"', "[fmu.parameters]"]
        lines += [f"{key} = {json.dumps(value)}" for key, value in parameters.items()]
    for start, end_ in connections:
        lines += ["[[connection]]", f'from = "{start}"', f'to = "{end_}"']
    lines += ["[coupling]", f'method = "{method}"']
    path = folder / f"{name}.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def run(program, path):
    out = path.with_suffix("")
    done = subprocess.run([program, "run", path, "--out", out, "--quiet"], capture_output=True, text=True)
    return done, out / "results.csv"


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    names = [name.split(" [")[0] for name in rows[0]]
    return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(names)}


def largest_error(table, name):
    exact = [-SAG * (1.0 - math.cos(2.0 * math.pi * time)) for time in table["time"]]
    return max(abs(a - b) for a, b in zip(table[name], exact)) / SAG


def coupled_to_the_fluid(folder, program, stranger, fmus):
    scene = {"scene": str(ROOT / "scenes" / "piston.toml"), "scene_overrides": "fluid.threads=1"}
    parts = {"mass": (stranger, {}), "fluid": (fmus / "fluid.fmu", scene)}
    links = [
        ("mass.place", "fluid.body.piston.motion.y"),
        ("mass.velocity", "fluid.body.piston.motion.vy"),
        ("mass.acceleration", "fluid.body.piston.motion.ay"),
        ("fluid.body.piston.load.fy", "mass.load"),
        ("fluid.body.piston.load.ay", "mass.load_acceleration"),
        ("fluid.added_mass.piston.y.piston.y", "mass.added_mass"),
    ]
    for method in ["explicit", "auto"]:
        done, results = run(program, case(folder, f"piston_{method}", parts, links, method))
        assert done.returncode == 0, done.stderr
        error = largest_error(columns(results), "mass.place")
        assert error < 0.02, f"{method}: error {error} of the sag"
        assert ("saves no states" in done.stderr) == (method == "auto"), done.stderr
        print(f"a stranger on our water, {method}: largest error {100 * error:.2f} % of the sag")
    done, _ = run(program, case(folder, "piston_iqn_ils", parts, links, "iqn_ils"))
    assert done.returncode != 0 and "saving and restoring states" in done.stderr and "explicit" in done.stderr, done.stderr
    print("iqn_ils without states: refused")


def two_strangers(folder, program, stranger):
    # The first hangs on its spring, the second takes the first one's acceleration as its load.
    parts = {"one": (stranger, {"mass": 220.0}), "two": (stranger, {"mass": 1.0, "stiffness": 0.0, "gravity": 0.0})}
    done, results = run(program, case(folder, "strangers", parts, [("one.acceleration", "two.load")]))
    assert done.returncode == 0, done.stderr
    table = columns(results)
    error = largest_error(table, "one.place")
    apart = max(abs(a - b) for a, b in zip(table["one.velocity"], table["two.velocity"]))
    assert error < 1e-3 and apart < 1e-9, (error, apart)
    print(f"two strangers: error {error:.1e}, velocities {apart:.1e} m/s apart")


def container(folder, program, fmus):
    from third_party import STEP, make_container

    subprocess.run([program, "ssp", "piston", "--out", folder / "piston.ssp"], check=True, capture_output=True)
    with zipfile.ZipFile(folder / "piston.ssp") as archive:
        archive.extractall(folder / "package")
    path = make_container(folder / "piston.ssp", folder / "package")
    done, results = run(program, case(folder, "container_case", {"all": (path, {})}, [], step=STEP))
    assert done.returncode == 0, done.stderr
    error = largest_error(columns(results), "all.y")
    assert error < 0.02, error
    print(f"a container of both: largest error {100 * error:.2f} % of the sag")


def main():
    fmus, program = (Path(argument).resolve() for argument in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        stranger = build(folder)
        coupled_to_the_fluid(folder, program, stranger, fmus)
        two_strangers(folder, program, stranger)
        container(folder, program, fmus)
    print("foreign FMUs passed")


if __name__ == "__main__":
    main()
