"""The common dam break with Plimsoll and with SPlisHSPlasH, in turn on one machine.

    python3 -m venv venv && venv/bin/pip install pysplishsplash numpy
    venv/bin/python docs/benchmarks/peers/dam_break.py --plimsoll target/release/plimsoll --spacings 0.004,0.002

Optional: not a part of the tests. SPlisHSPlasH (Bender and others, https://github.com/InteractiveComputerGraphics/SPlisHSPlasH)
runs divergence-free SPH (Bender and Koschier 2015) with a density error of 0.1 % in two dimensions. Its wheel brings a libGLdispatch
that may not fit the system's libGL and then crashes at import: put a link to the system's own in its place.

Task: column 0.146 x 0.292 m in a tank of 0.584 m, frictionless walls, 0.5 s. Energy is that of the particles, kinetic and potential,
over its first value.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TANK = (0.584, 1.2)
COLUMN = (0.146, 0.292)
END = 0.5
BOX = "\n".join(
    [f"v {x} {y} {z}" for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    + ["f 1 2 4", "f 1 4 3", "f 5 7 8", "f 5 8 6", "f 1 5 6", "f 1 6 2", "f 3 4 8", "f 3 8 7", "f 1 3 7", "f 1 7 5", "f 2 6 8", "f 2 8 4"]
)


def scene(spacing, folder):
    """Scene of SPlisHSPlasH: particles start half a spacing from the walls."""
    (folder / "box.obj").write_text(BOX + "\n")
    half = 0.5 * spacing
    width, height = TANK
    configuration = {
        "particleRadius": half, "sim2D": True, "density0": 1000, "timeStepSize": 1e-4, "gravitation": [0, -9.81, 0],
        "simulationMethod": 4, "boundaryHandlingMethod": 0, "cflMethod": 1, "cflFactor": 0.4, "cflMaxTimeStepSize": 0.001,
        "maxIterations": 1000, "maxError": 0.1, "maxIterationsV": 1000, "maxErrorV": 0.1, "enableDivergenceSolver": True,
        "stopAt": END, "enableVTKExport": False, "enablePartioExport": False, "enableStateExport": False, "stepsPerRenderStep": 1,
    }
    walls = {
        "geometryFile": "box.obj", "translation": [0.5 * width, 0.5 * height, 0], "rotationAxis": [1, 0, 0], "rotationAngle": 0,
        "scale": [width + spacing, height + spacing, 1], "isDynamic": False, "isWall": True, "samplingMode": 0,
    }
    block = {"denseMode": 0, "start": [-half, -half, -1], "end": [COLUMN[0] + half, COLUMN[1] + half, 1]}
    # Without viscosity, as the walls are without friction.
    material = {"id": "Fluid", "density0": 1000, "viscosityMethod": 0}
    path = folder / "dam_break.json"
    path.write_text(json.dumps(
        {"Configuration": configuration, "Materials": [material], "RigidBodies": [walls], "FluidBlocks": [block]}))
    return path


def splishsplash(spacing, folder):
    """Runs in this process; prints one line of JSON."""
    import numpy as np
    import pysplishsplash as sph

    base = sph.Exec.SimulatorBase()
    base.init(sceneFile=str(scene(spacing, folder)), useGui=False, outputDir=str(folder / "out"), stopAt=END)
    base.initSimulation()
    simulation = sph.Simulation.getCurrent()
    model = simulation.getFluidModel(0)
    count = model.numActiveParticles()
    if count == 0:
        sys.exit("SPlisHSPlasH made no particles")
    seen = {"energy": [], "front": {}, "steps": 0}

    def look():
        positions = np.array([model.getPosition(i) for i in range(count)])
        velocities = np.array([model.getVelocity(i) for i in range(count)])
        energy = float((0.5 * (velocities**2).sum(axis=1) + 9.81 * positions[:, 1]).mean())
        return energy, float(positions[:, 0].max()) + 0.5 * spacing

    spent = 0.0
    wanted = [0.1, 0.15, 0.2]
    first, _ = look()

    def after_step():
        nonlocal spent
        seen["steps"] += 1
        now = sph.TimeManager.getCurrent().getTime()
        if wanted and now >= wanted[0]:
            start = time.perf_counter()
            energy, front = look()
            seen["front"][wanted.pop(0)] = front
            seen["energy"].append((now, energy / first))
            spent += time.perf_counter() - start

    base.setTimeStepCB(after_step)
    start = time.perf_counter()
    base.runSimulation()
    wall = time.perf_counter() - start - spent
    energy, _ = look()
    print(json.dumps({
        "wall": wall, "particles": count, "steps": seen["steps"], "energy": energy / first,
        "energy_0.2": seen["energy"][-1][1] if seen["energy"] else None, "front": seen["front"]}))
    base.cleanup()


def plimsoll(program, spacing, folder, courant):
    """Runs the program; the figures are those of its summary."""
    out = folder / f"plimsoll-{spacing}"
    command = [program, "run", "dam_break_peers", "--quiet", "--out", str(out), "--set", f"fluid.spacing={spacing}"]
    command += ["--set", f"fluid.voronoi.courant={courant}"] if courant else []
    subprocess.run(command, check=True)
    summary = json.loads((out / "summary.json").read_text())
    with open(out / "results.csv") as table:
        rows = csv.DictReader(table)
        summary["substeps"] = round(sum(float(row["fluid.solver.substeps [1]"]) for row in rows))
    return summary


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plimsoll", default="target/release/plimsoll")
    parser.add_argument("--spacings", default="0.004,0.002")
    parser.add_argument("--courant", help="Courant number of Plimsoll; its default without")
    parser.add_argument("--splishsplash", type=float, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if arguments.splishsplash:
            splishsplash(arguments.splishsplash, folder)
            return
        print("| spacing [m] | program | wall-clock time [s] | steps | energy left | front at 0.1, 0.15, 0.2 s [m] |\n|---|---|---|---|---|---|")
        for spacing in map(float, arguments.spacings.split(",")):
            command = [sys.executable, __file__, "--splishsplash", str(spacing)]
            text = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": str(os.cpu_count())})
            lines = [line for line in text.stdout.splitlines() if line.startswith("{")]
            if not lines:
                sys.exit(f"SPlisHSPlasH ended with {text.returncode}: {text.stderr[-500:]}")
            other = json.loads(lines[-1])
            fronts = ", ".join(f"{value:.3f}" for value in other["front"].values())
            print(f"| {spacing} | SPlisHSPlasH | {other['wall']:.1f} | {other['steps']} | {other['energy']:.3f} | {fronts} |", flush=True)
            own = plimsoll(arguments.plimsoll, spacing, folder, arguments.courant)
            checks = {name: check["value"] for name, check in own["checks"].items()}
            fronts = ", ".join(f"{checks[f'front at {t} s']:.3f}" for t in ("0.1", "0.15", "0.2"))
            left = 1.0 + checks["energy lost by 0.5 s"]
            print(f"| {spacing} | Plimsoll | {own['wall_seconds']:.1f} | {own['substeps']} | {left:.3f} | {fronts} |", flush=True)


main()
