"""The fluid as an FMU in FMPy: a tank at rest, its pressure, and a state that is saved and restored.

usage: fmu_in_fmpy.py FLUID.fmu        (`plimsoll pack hydrostatic` makes the FMU; needs fmpy)
"""

import shutil
import sys
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave


def main():
    archive = Path(sys.argv[1])
    description = fmpy.read_model_description(archive)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    folder = fmpy.extract(archive)
    identifier = description.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="tank")
    fmu.instantiate()
    # Parameters come before the initialisation: here a coarser spacing.
    fmu.setReal([references["particle_spacing"]], [0.02])
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()

    def pressure():
        return fmu.getReal([references["probe.floor_middle.pressure"]])[0]

    step, before = 0.01, None
    for number in range(10):
        if number == 5:
            # What a master that iterates does: keep the state, step, look, go back.
            kept = fmu.getFMUState()
            fmu.doStep(number * step, step)
            before = pressure()
            fmu.setFMUState(kept)
            fmu.freeFMUState(kept)
        fmu.doStep(number * step, step)
        print(f"t = {(number + 1) * step:.2f} s: {pressure():10.3f} Pa on the floor")
        if number == 5 and pressure() != before:
            sys.exit(f"the step repeated from the saved state gave {pressure()} Pa instead of {before} Pa")
    fmu.terminate()
    fmu.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
