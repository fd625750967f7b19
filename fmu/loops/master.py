"""What the loops share: one FMU instance through FMPy's low-level interface, FMI 3, and where files go."""

import argparse
import functools
import os
import shutil
import subprocess
from pathlib import Path

import fmpy
from fmpy.fmi3 import FMU3Slave

ROOT = Path(__file__).resolve().parents[2]


def command(*words):
    """Runs the command `stickslip`: of the build that STICKSLIP_BUILD names, or by cargo."""
    build = os.environ.get("STICKSLIP_BUILD")
    start = [os.path.join(build, "stickslip")] if build else ["cargo", "run", "--quiet", "--release", "--"]
    subprocess.run([*start, *map(str, words)], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


def arguments(description, *more):
    """Command line of a loop: the FMU (packed from the paper's example when absent) and the folder of the pictures."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fmu", help="an FMI 3 FMU with the input `press` (default: packs the example kazmi2014)")
    parser.add_argument("--out", default=str(ROOT / "out" / "loops"), help="folder of the pictures")
    for name, options in more:
        parser.add_argument(name, **options)
    found = parser.parse_args()
    os.makedirs(found.out, exist_ok=True)
    if not found.fmu:
        found.fmu = os.path.join(found.out, "kazmi2014.fmu")
        command("fmu", "kazmi2014", "-o", os.path.abspath(found.fmu))
    return found


class Pad:
    """One instance. Values are set and read by the names of the model description.

    These masters know the load at the end of a step, or look for it by repeating the step: inputs mean that one.
    """

    def __init__(self, fmu, parameters=None, **inputs):
        self.description = fmpy.read_model_description(fmu)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.folder = fmpy.extract(fmu)
        self.slave = FMU3Slave(
            guid=self.description.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="pad",
        )
        self.slave.instantiate()
        self.start({**(parameters or {}), **inputs})

    def start(self, values):
        self.choose("time.inputs", "end_of_step")
        for key, value in values.items():
            self.set(key, value)
        self.slave.enterInitializationMode(startTime=0.0)
        self.slave.exitInitializationMode()

    def restart(self, **values):
        """Starts over with these values and those of a fresh instance."""
        self.slave.reset()
        self.start(values)

    def choose(self, name, word):
        """Sets an enumeration."""
        items = {item.name: int(item.value) for item in self.variables[name].declaredType.items}
        self.slave.setInt64([self.reference(name)], [items[word]])

    def reference(self, name):
        return self.variables[name].valueReference

    def set(self, name, value):
        self.slave.setFloat64([self.reference(name)], [value])

    def get(self, name):
        variable = self.variables[name]
        if not variable.dimensions:
            return self.slave.getFloat64([variable.valueReference])[0]
        count = 1
        for size in variable.shape:
            count *= size
        return list(self.slave.getFloat64([variable.valueReference], nValues=count))

    def step(self, t, h):
        self.slave.doStep(currentCommunicationPoint=t, communicationStepSize=h)

    def save(self):
        return self.slave.getFMUState()

    def restore(self, state):
        self.slave.setFMUState(state)

    def drop(self, state):
        self.slave.freeFMUState(state)

    def derivative(self, output, knob):
        """d output / d input over the last step."""
        return self.slave.getDirectionalDerivative([self.reference(output)], [self.reference(knob)], [1.0])[0]

    def close(self):
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder)


@functools.cache
def shared(fmu):
    """The one instance of this process; its folder is not needed any more once the library is loaded."""
    pad = Pad(fmu)
    shutil.rmtree(pad.folder, ignore_errors=True)
    return pad


def check(what, passed):
    print(f"{'ok  ' if passed else 'FAIL'}  {what}")
    if not passed:
        raise SystemExit(1)


def figure(labels, title, x="time, s"):
    """Plots one below the other, each with its label, over one axis `x`."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rows = len(labels)
    fig, axes = plt.subplots(rows, 1, figsize=(8, 2.5 * rows), sharex=True, layout="constrained", squeeze=False)
    fig.suptitle(title)
    for axis, label in zip(axes[:, 0], labels):
        axis.set_ylabel(label)
        axis.grid(color="0.9")
        axis.set_axisbelow(True)
    axes[-1, 0].set_xlabel(x)
    return fig, axes[:, 0]


def save(fig, axes, options, name):
    """Writes the picture; every plot that has several curves gets its legend."""
    for axis in axes:
        if len(axis.get_legend_handles_labels()[0]) > 1:
            axis.legend(fontsize=8)
    fig.align_ylabels()
    fig.savefig(os.path.join(options.out, name), dpi=110)
