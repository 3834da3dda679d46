"""Runs the piston scene in masters that know nothing of implicit coupling, and compares with the exact motion.

    python third_party.py PLIMSOLL

PLIMSOLL is the bundled program: it exports the scene as a System Structure Package and packs the FMUs. The water is ten
times as heavy as the piston: a plain exchange without iteration fails within a few steps. With the added mass connected
each of these masters must follow the exact swing, x = -sag (1 - cos 2 pi t), within 2 % of the sag:

- FMPy's SSP simulation (Jacobi: all FMUs step with the values of the last step; no initial exchange);
- ecos (ecospy; reads the package, Jacobi);
- libcosim (libcosimpy; reads the unpacked package, fixed-step Jacobi);
- a container made by fmucontainer, run by FMPy as one FMU.

Needs the packages of requirements-third-party.txt. ecos needs libtbb, which the package tbb brings: the script starts itself
again with that folder in LD_LIBRARY_PATH.
"""

import json
import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np

SAG = 0.2484902029  # (m_s + rho H W) g / k of the scene, J_piston_added_mass: 220 kg, 8685.251873 N/m
LIMIT = 0.02
STEP, END = 0.002, 1.0


def exact(time):
    return -SAG * (1.0 - np.cos(2.0 * np.pi * np.asarray(time)))


def with_fmpy(package, folder):
    from fmpy.ssp.simulation import simulate_ssp

    # FMPy sets no text parameters: the FMUs start with the scene that they were packed for.
    result = simulate_ssp(str(package), stop_time=END, step_size=STEP)
    (column,) = [name for name in result.dtype.names if name.endswith("structure.body.piston.motion.y")]
    return result["time"] + STEP, result[column]


def with_ecos(package, folder):
    from ecospy.EcosSimulation import EcosSimulation

    times, places = [], []
    with EcosSimulation(step_size=STEP, ssp_path=str(package)) as simulation:
        simulation.init(parameter_set="piston")
        for _ in range(round(END / STEP)):
            simulation.step()
            times.append(simulation.get_time())
            places.append(simulation.get_real("structure::body.piston.motion.y"))
        simulation.terminate()
    return times, places


def with_libcosim(package, folder):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution = CosimExecution.from_ssp_file(str(folder), step_size=round(1e9 * STEP))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    structure = execution.slave_index_from_instance_name("structure")
    variables = {v.name.decode(): v.reference for v in execution.slave_variables(structure)}
    times, places = [], []
    for step in range(round(END / STEP)):
        execution.step()
        times.append((step + 1) * STEP)
        places.append(observer.last_real_values(structure, [variables["body.piston.motion.y"]])[0])
    return times, places


def make_container(package, folder):
    """One FMU of both, with the height of the piston as its output `y`."""
    from fmpy.ssp.ssd import read_ssd

    connections = read_ssd(str(package)).system.connections
    resources = folder / "resources"
    plan = {
        "name": "container.fmu",
        "fmu": ["structure.fmu", "fluid.fmu"],
        "auto_input": False,
        "auto_output": False,
        "auto_link": False,
        "mt": False,
        "sequential": True,
        "step_size": STEP,
        "link": [
            [f"{c.startElement}.fmu", c.startConnector, f"{c.endElement}.fmu", c.endConnector] for c in connections
        ],
        "output": [["structure.fmu", "body.piston.motion.y", "y"]],
    }
    (resources / "plan.json").write_text(json.dumps(plan))
    tool = Path(sys.executable).parent / "fmucontainer"
    command = [str(tool), "-fmu-directory", str(resources), "-container", "plan.json"]
    made = subprocess.run(command, capture_output=True, text=True)
    container = resources / "container.fmu"
    assert container.is_file(), made.stdout + made.stderr
    return container


def with_container(package, folder):
    from fmpy import simulate_fmu

    container = make_container(package, folder)
    result = simulate_fmu(str(container), stop_time=END, step_size=STEP, output_interval=STEP, output=["y"])
    return result["time"], result["y"]


MASTERS = {"fmpy": with_fmpy, "ecos": with_ecos, "libcosim": with_libcosim, "container": with_container}


def run(name, program):
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        package = folder / "piston.ssp"
        subprocess.run([program, "ssp", "piston", "--out", package], check=True, capture_output=True)
        with zipfile.ZipFile(package) as archive:
            archive.extractall(folder)
        times, places = MASTERS[name](package, folder)
    times, places = np.asarray(times), np.asarray(places)
    assert len(times) >= round(END / STEP), f"{name}: {len(times)} steps"
    error = np.abs(places - exact(times)).max() / SAG
    print(f"{name}: largest error {100 * error:.2f} % of the sag in {len(times)} steps of {STEP} s", flush=True)
    assert np.isfinite(error) and error < LIMIT, f"{name}: error {error}, expected less than {LIMIT}"


def main():
    program = str(Path(sys.argv[1]).resolve())
    if len(sys.argv) > 2:
        run(sys.argv[2], program)
        return
    # Each master in a process of its own: they bring shared libraries that do not agree with each other.
    libraries = Path(sys.executable).parent.parent / "lib"
    path = os.pathsep.join([str(libraries), *filter(None, [os.environ.get("LD_LIBRARY_PATH")])])
    failed = []
    for name in MASTERS:
        environment = {**os.environ, "LD_LIBRARY_PATH": path} if name == "ecos" else None
        done = subprocess.run([sys.executable, __file__, program, name], env=environment, timeout=600)
        if done.returncode != 0:
            failed.append(name)
    if failed:
        raise SystemExit(f"failed: {', '.join(failed)}")
    print(f"{len(MASTERS)} masters passed")


if __name__ == "__main__":
    main()
