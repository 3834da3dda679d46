"""Checks both packed FMUs with FMPy: the description, and a run of each alone against exact or measured figures.

    python check_fmus.py FOLDER PLIMSOLL

FOLDER holds fluid.fmu and structure.fmu as `plimsoll pack` writes them; PLIMSOLL is the program, which packs those of other
scenes into folders there. Needs fmpy 0.3.32; runs `fmutool -check` of
fmu-manipulation-toolbox as well when it is installed. Exit code 0 only when every check passed.
"""

import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

GRAVITY = 9.81
FAILURES = []
PASSED = []


def check(name, passed, detail):
    """Prints one line and remembers a failure."""
    print(f"{'ok  ' if passed else 'FAIL'} {name}: {detail}")
    (PASSED if passed else FAILURES).append(name)


def simulate(fmu, stop, step, start_values, output, signals=None, messages=None):
    """A fixed-step co-simulation from 0 with one row per communication step; messages are added to a list."""
    messages = [] if messages is None else messages
    return simulate_fmu(
        str(fmu),
        fmi_type="CoSimulation",
        start_time=0.0,
        stop_time=stop,
        output_interval=step,
        start_values=start_values,
        input=signals,
        output=output,
        logger=lambda environment, instance, status, category, message: messages.append(message.decode()),
    )


def check_description(fmu):
    problems = validate_fmu(str(fmu))
    check(f"fmpy validate {fmu.name}", not problems, "no problem" if not problems else "; ".join(problems))
    description = read_model_description(str(fmu))
    slave = description.coSimulation
    check(
        f"{fmu.name} can save and serialise states",
        slave.canGetAndSetFMUstate and slave.canSerializeFMUstate and slave.canHandleVariableCommunicationStepSize,
        f"GUID {description.guid}",
    )
    direct = [unknown.variable.name for unknown in description.outputs if unknown.dependencies is None or unknown.dependencies]
    check(f"{fmu.name} writes out that outputs depend on the state only", not direct, f"{len(description.outputs)} outputs")


def check_with_toolbox(fmu):
    tool = shutil.which("fmutool", path=str(Path(sys.executable).parent))
    if tool is None:
        print(f"skip fmutool -check {fmu.name}: fmu-manipulation-toolbox is not installed")
        return
    done = subprocess.run([tool, "-input", str(fmu), "-check"], capture_output=True, text=True, check=False)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if "ERROR" in line or "WARNING" in line]
    check(f"fmutool -check {fmu.name}", done.returncode == 0 and not lines, "; ".join(lines) or "no error")


def check_hydrostatic(fluid):
    """Water at rest, H = 0.5 m: p = rho g (H - y)."""
    depth, width = 0.5, 1.0
    foot, half = "probe.floor_middle.pressure", "probe.wall_half_depth.pressure"
    names = [foot, half, "wall.force_y", "centre.y", "energy.kinetic", "particles.lost"]
    start = {"particle_spacing": 0.025}
    result = simulate(fluid, 1.0, 0.01, start, names)
    late = result[result["time"] >= 0.3]
    for name, exact in [
        (foot, 1000 * GRAVITY * depth),
        (half, 1000 * GRAVITY * 0.5 * depth),
        ("wall.force_y", -1000 * GRAVITY * depth * width),
    ]:
        mean = float(np.mean(late[name]))
        check(f"hydrostatic, mean {name}", abs(mean - exact) < 0.05 * abs(exact), f"{mean:.1f}, exact {exact:.1f}")
    fall = float(result["centre.y"][0] - result["centre.y"][-1])
    check("hydrostatic, fall of the centre of mass", abs(fall) < 0.01 * depth, f"{fall / depth:.2e} of H")
    lost = int(result["particles.lost"][-1])
    check("hydrostatic, particles lost", lost == 0, f"{lost}")


def check_front(fluid):
    """Martin and Moyce 1952, n^2 = 2: Z = x / a against T = t sqrt(2 g / a), late speed dZ/dT = 1.36."""
    width = 0.05715
    start = {"particle_spacing": width / 12.5}
    result = simulate(fluid, 0.2, 0.002, start, ["front.x", "particles.lost", "solver.substeps"])
    place = result["front.x"] / width
    time = result["time"] * math.sqrt(2 * GRAVITY / width)
    window = (result["time"] >= 0.11) & (result["time"] <= 0.19)
    speed = float(np.polyfit(time[window], place[window], 1)[0])
    check("dam_break_front, late speed", abs(speed - 1.36) < 0.2, f"{speed:.3f}, measured 1.36")
    check("dam_break_front, particles lost", int(result["particles.lost"][-1]) == 0, f"front at Z = {place[-1]:.2f}")


def check_held_plate(fluid):
    """An unconnected fluid sees the body held still: the wave reaches the plate and pushes it along +X, -eta."""
    start = {"scene": "dam_break_plate", "particle_spacing": 0.008, "threads": 1}
    force, modal = "body.base.load.fx", "body.base.plate.load.q1"
    result = simulate(fluid, 0.3, 0.001, start, [force, modal, "front.x", "particles.lost"])
    before = result[result["time"] < 0.1]
    quiet = float(np.max(np.abs(before[modal])))
    check("held plate, no load before the wave comes", quiet == 0.0, f"largest |{modal}| {quiet:.1e}")
    pushed = float(np.max(result[force]))
    check("held plate, the wave pushes it", pushed > 0 and float(np.min(result[modal])) < 0, f"peak {pushed:.1f} N/m")
    lost = int(result["particles.lost"][-1])
    check("held plate, particles lost", lost == 0, f"{lost}")


def check_structure(structure):
    """A constant load on the first mode from rest: q = Q / w^2 (1 - cos w t)."""
    stiffness, line_density, length = 1e6 * 0.012**3 / 12, 30.0, 0.08
    omega = 1.875104068711961**2 * math.sqrt(stiffness / line_density) / length**2
    load, step, stop = 0.05, 1e-4, 0.5
    signals = np.array([(0.0, load), (stop, load)], dtype=[("time", np.float64), ("body.base.plate.load.q1", np.float64)])
    start = {"scene": "free_decay", "scene_overrides": "body.base.member.plate.initial_modes=[]"}
    place = "body.base.plate.motion.q1"
    names = [place, "energy.kinetic", "energy.potential", "body.base.plate.deflection.tip"]
    result = simulate(structure, stop, step, start, names, signals)
    exact = load / omega**2 * (1 - np.cos(omega * result["time"]))
    error = float(np.max(np.abs(result[place] - exact))) / (load / omega**2)
    # Newmark's period error (omega h)^2 / 12 over omega t = 19 rad.
    check("structure under a constant load", error < 5e-5, f"error {error:.1e} of the static deflection")
    work = load * result[place]
    energy = result["energy.kinetic"] + result["energy.potential"]
    imbalance = float(np.max(np.abs(work - energy)) / np.max(work))
    check("structure, work of the load is its energy", imbalance < 1e-9, f"{imbalance:.1e}")


def check_refusal(fluid):
    """A wrong key stops the initialisation with a message that names the right one, and a scene with others its variable."""
    for start, words in [
        ({"scene_overrides": "fluid.spacin=1"}, "`spacing`"),
        ({"scene": "hydrostatic"}, "probe.floor_middle.pressure"),
    ]:
        check_refused(fluid, start, words)


def check_refused(fluid, start, words):
    messages = []
    try:
        simulate(fluid, 0.1, 0.01, start, ["front.x"], messages=messages)
        failed = ""
    except Exception as error:  # fmpy raises its own type, named after the call that failed
        failed = str(error)
    text = " ".join(messages)
    passed = "fmi2EnterInitializationMode" in failed and words in text
    check(f"{'; '.join(start.values())} is refused", passed, text or failed)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    fluid, structure = folder / "fluid.fmu", folder / "structure.fmu"

    def packed(scene):
        subprocess.run([sys.argv[2], "pack", scene, "--out", str(folder / scene)], check=True, stdout=subprocess.DEVNULL)
        return folder / scene / "fluid.fmu", folder / scene / "structure.fmu"

    tank, front = packed("hydrostatic")[0], packed("dam_break_front")[0]
    for fmu in (fluid, structure, tank, *packed("damaged_cabin")):
        check_description(fmu)
        check_with_toolbox(fmu)
    check_structure(structure)
    check_hydrostatic(tank)
    check_front(front)
    check_held_plate(fluid)
    check_refusal(fluid)
    print(f"{len(PASSED)} passed, {len(FAILURES)} failed")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
