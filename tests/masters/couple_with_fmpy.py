"""Couples both FMUs in Python and compares with the bundled master, value by value.

    python couple_with_fmpy.py FOLDER PLIMSOLL

FOLDER holds fluid.fmu and structure.fmu as `plimsoll pack` writes them, PLIMSOLL is the bundled master's program. Each
coupling method runs twice, here with FMPy and there, on a coarse dam break against the elastic plate; every number of the
two tables must agree to 1e-9 of the column's size. Needs fmpy 0.3.32.

The methods are those of docs/coupling.md: explicit; implicit with constant relaxation, Aitken's factor or IQN-ILS, with
fmi2GetFMUstate and fmi2SetFMUstate around each iteration.
"""

import csv
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

TOLERANCE = 1e-9
STEP, END = 0.0005, 0.2
RELATIVE, ABSOLUTE, MAXIMUM_ITERATIONS, RELAXATION, REUSED_STEPS, ORDER = 1e-6, 1e-6, 60, 0.5, 4, 1
SCENE = Path(__file__).resolve().parents[2] / "scenes" / "dam_break_plate.toml"
# A column near the plate, so that most steps have a wet plate; a heavy plate, so that explicit coupling is stable.
COMMON = {
    "run.end": END,
    "run.communication_step": STEP,
    "output.interval": 0.0,
    "output.record_interval": 0.0,
    "fluid.spacing": 0.008,
    "fluid.threads": 1,
    "fluid.water.0.polygon": "[[0.1, 0.0], [0.246, 0.0], [0.246, 0.15], [0.1, 0.15]]",
    # The plain explicit exchange; third_party.py runs the one with added mass.
    "coupling.added_mass": "false",
    "coupling.relaxation": RELAXATION,
    "coupling.tolerance_relative": RELATIVE,
    "coupling.tolerance_absolute": ABSOLUTE,
    "coupling.maximum_iterations": MAXIMUM_ITERATIONS,
    "coupling.reused_steps": REUSED_STEPS,
    # No step is halved, neither here nor there.
    "coupling.smallest_step": STEP,
}
METHODS = {
    # An exchange without iteration does not extrapolate unless it is asked to.
    "explicit": {"body.base.member.plate.density": 25000.0},
    "constant": {"body.base.member.plate.density": 25000.0, "coupling.predictor_order": ORDER},
    "aitken": {"coupling.predictor_order": ORDER},
    "iqn_ils": {"coupling.predictor_order": ORDER},
}


class Participant:
    """One FMU with the references of the variables that are exchanged."""

    def __init__(self, archive, name, scene, overrides):
        self.name = name
        self.folder = extract(str(archive))
        description = read_model_description(str(archive))
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate()
        self.fmu.setString([self.references["scene"]], [str(scene)])
        self.fmu.setString([self.references["scene_overrides"]], [overrides])
        self.fmu.setupExperiment(startTime=0.0, stopTime=END)
        self.fmu.enterInitializationMode()
        self.state = None

    def get(self, names):
        return np.array(self.fmu.getReal([self.references[name] for name in names]))

    def set(self, names, values):
        self.fmu.setReal([self.references[name] for name in names], list(values))

    def save(self):
        if self.state is not None:
            self.fmu.freeFMUstate(self.state)
        self.state = self.fmu.getFMUstate()

    def restore(self):
        self.fmu.setFMUstate(self.state)

    def close(self):
        if self.state is not None:
            self.fmu.freeFMUstate(self.state)
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def dot(a, b):
    """Sum in the order of the entries: a library's own order differs from machine to machine, and splashing water makes
    a large difference of a last digit within tenths of a second."""
    return sum(x * y for x, y in zip(a, b))


def norm(a):
    return np.sqrt(dot(a, a))


class Constant:
    """Q + omega r."""

    def start_step(self):
        pass

    def next(self, used, produced):
        return used + RELAXATION * (produced - used)

    def accept(self, used, produced):
        pass


class Aitken(Constant):
    """Irons and Tuck 1969: omega <- -omega r_old . (r - r_old) / |r - r_old|^2."""

    def __init__(self):
        self.factor, self.last = RELAXATION, None

    def start_step(self):
        self.factor = np.copysign(min(abs(self.factor), RELAXATION), self.factor)
        self.last = None

    def next(self, used, produced):
        residual = produced - used
        if self.last is not None:
            change = residual - self.last
            square = dot(change, change)
            if square > 0:
                self.factor *= -dot(self.last, change) / square
        self.last = residual
        return used + self.factor * residual


class IqnIls(Constant):
    """Degroote, Bathe and Vierendeels 2009, columns newest first, QR2 filter, weights from residual sums."""

    FILTER = 1e-2

    def __init__(self):
        self.past = []

    def start_step(self):
        self.current, self.last, self.sums = [], None, 0.0

    def learn(self, used, produced):
        residual = produced - used
        length = norm(residual)
        if length > 0:
            self.sums = self.sums + abs(residual) / length
        if self.last is not None:
            column = (residual - self.last[0], produced - self.last[1])
            if norm(column[0]) > 0:
                self.current.insert(0, column)
        self.last = (residual, produced)
        return residual

    def weights(self, size):
        sums = self.sums * np.ones(size)
        largest = sums.max()
        return np.where(sums > 1e-10 * largest, 1 / np.where(sums > 0, sums, 1), 1 / max(largest, 1e-300))

    def next(self, used, produced):
        residual = self.learn(used, produced)
        weights = self.weights(len(used))
        basis, outputs, rows = [], [], []
        for change, output in self.current + [column for step in self.past for column in step]:
            if len(basis) == len(used):
                break
            vector = weights * change
            rest, projections = vector.copy(), np.zeros(len(basis))
            for _ in range(2):
                for index, direction in enumerate(basis):
                    part = dot(direction, rest)
                    rest = rest - part * direction
                    projections[index] += part
            length = norm(rest)
            if length > self.FILTER * norm(vector):
                basis.append(rest / length)
                outputs.append(output)
                rows.append(np.append(projections, length))
        if not basis:
            return used + RELAXATION * residual
        right = -weights * residual
        factors = [dot(direction, right) for direction in basis]
        for k in reversed(range(len(basis))):
            factors[k] /= rows[k][k]
            for j in range(k):
                factors[j] -= rows[k][j] * factors[k]
        return produced + sum(output * factor for output, factor in zip(outputs, factors))

    def accept(self, used, produced):
        self.learn(used, produced)
        self.past = ([self.current] if self.current else []) + self.past
        self.past = self.past[:REUSED_STEPS]


ACCELERATORS = {"explicit": None, "constant": Constant, "aitken": Aitken, "iqn_ils": IqnIls}


def predict(history, initial, time):
    """Lagrange's polynomial through the middles of the last steps, at the middle of this one."""
    if not history:
        return initial
    middle, guess = time + 0.5 * STEP, 0.0
    for i, (t_i, values) in enumerate(history):
        weight = np.prod([(middle - t_j) / (t_i - t_j) for j, (t_j, _) in enumerate(history) if j != i])
        guess = guess + weight * values
    return guess


def couple(folder, overrides, method, columns):
    """Rows of (time, values of the columns) as the bundled master would record them, and the passes."""
    loads = [f"body.base.plate.load.q{i}" for i in (1, 2, 3)]
    motions = [f"body.base.plate.motion.{order}q{i}" for i in (1, 2, 3) for order in ("", "v", "a")]
    structure = Participant(folder / "structure.fmu", "structure", SCENE, overrides)
    fluid = Participant(folder / "fluid.fmu", "fluid", SCENE, overrides)
    both = {"structure": structure, "fluid": fluid}
    for _ in range(2):
        structure.set(loads, fluid.get(loads))
        fluid.set(motions, structure.get(motions))
    for participant in both.values():
        participant.fmu.exitInitializationMode()

    def one_pass(time, guess):
        structure.set(loads, guess)
        structure.fmu.doStep(time, STEP)
        fluid.set(motions, structure.get(motions))
        fluid.fmu.doStep(time, STEP)
        return fluid.get(loads)

    def record(time):
        values = [both[owner].get([name])[0] for owner, name in columns]
        rows.append([time, *values])

    rows, history, passes, initial = [], [], 0, fluid.get(loads)
    # A plain explicit exchange does not extrapolate: it would be stable up to a third of the mass ratio only.
    order = ORDER if ACCELERATORS[method] else 0
    accelerator = ACCELERATORS[method] and ACCELERATORS[method]()
    record(0.0)
    for number in range(round(END / STEP)):
        time = STEP * number
        guess = predict(history, initial, time)
        if accelerator:
            structure.save()
            fluid.save()
            accelerator.start_step()
        for iteration in range(MAXIMUM_ITERATIONS):
            produced = one_pass(time, guess)
            passes += 1
            if not accelerator:
                break
            if np.all(abs(produced - guess) <= RELATIVE * abs(produced) + ABSOLUTE):
                accelerator.accept(guess, produced)
                break
            if iteration + 1 == MAXIMUM_ITERATIONS:
                sys.exit(f"{method}: no convergence at t = {time} s, residual {produced - guess}")
            guess = accelerator.next(guess, produced)
            structure.restore()
            fluid.restore()
        history = [(time + 0.5 * STEP, produced), *history][: order + 1]
        record(STEP * (number + 1))
    for participant in both.values():
        participant.close()
    return np.array(rows), passes


def run_bundled(plimsoll, overrides, folder):
    """Header and rows of the bundled master's results.csv."""
    command = [str(plimsoll), "run", str(SCENE), "--out", str(folder), "--quiet"]
    for key, value in overrides.items():
        command += ["--set", f"{key}={value}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    # 3: at its end, but outside a limit of the scene, which this set-up is not that of.
    if done.returncode not in (0, 3):
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    with open(folder / "results.csv", newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    return header, np.array(rows, dtype=float)


def real_columns(header, folder):
    """Place, participant and variable of every real output in the table, by the types of the model descriptions."""
    reals = {}
    for owner in ("fluid", "structure"):
        description = read_model_description(str(folder / f"{owner}.fmu"))
        reals[owner] = {variable.name for variable in description.modelVariables if variable.type == "Real"}
    columns = []
    for place, title in enumerate(header[1:], start=1):
        owner, _, name = title.split(" [")[0].partition(".")
        if name in reals.get(owner, ()):
            columns.append((place, owner, name))
    return columns


def compare(method, folder, plimsoll):
    overrides = {**COMMON, **METHODS[method], "coupling.method": method}
    with tempfile.TemporaryDirectory() as target:
        header, bundled = run_bundled(plimsoll, overrides, Path(target))
    columns = real_columns(header, folder)
    if len(columns) < 20:
        raise ValueError(f"only {len(columns)} columns of results.csv are real variables of the FMUs: are the names right?")
    text = "; ".join(f"{key}={value}" for key, value in overrides.items())
    ours, passes = couple(folder, text, method, [(owner, name) for _, owner, name in columns])
    if len(ours) != len(bundled):
        print(f"FAIL {method}: {len(ours)} rows here, {len(bundled)} there")
        return False
    worst, where = 0.0, header[0]
    for index, place in enumerate([0, *(place for place, _, _ in columns)]):
        size = np.max(np.abs(bundled[:, place]))
        error = np.max(np.abs(ours[:, index] - bundled[:, place])) / (size if size > 0 else 1.0)
        if not error <= worst:  # a difference that is no number counts as well
            worst, where = error, header[place]
    tip = np.max(np.abs(ours[:, 1 + [name for _, _, name in columns].index("body.base.plate.deflection.tip")]))
    moved = tip > 1e-5
    passed = worst <= TOLERANCE and moved
    steps = len(ours) - 1
    print(
        f"{'ok  ' if passed else 'FAIL'} {method}: {steps} steps, {passes / steps:.2f} passes a step, largest tip deflection "
        f"{1000 * tip:.3f} mm, {len(columns)} columns differ by at most {worst:.1e} ({where})"
    )
    return passed


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder, plimsoll = Path(sys.argv[1]), Path(sys.argv[2])
    results = [compare(method, folder, plimsoll) for method in METHODS]
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()
