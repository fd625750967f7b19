"""What a step costs through FMPy, beside FMPy's own floor: the same calls on an FMU whose functions do nothing.

The cost of the step itself is measured on the C function, without FMPy's marshalling, and given apart:
(total - step itself) / floor is the ratio to watch. Prints a table; needs a C compiler.
"""

import re
import subprocess
import tempfile
import time
import zipfile
from ctypes import CDLL, c_double, c_int, c_void_p
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from master import ROOT, arguments, command

H = 1 / 256  # below the internal step: one internal step a call
OUTPUTS = ("tangential_stress", "slip_rate", "slip", "accumulated_slip", "stick")


def idle(fmu, folder):
    """A copy of an FMU whose functions return at once: 0, or a pointer where an instance is asked for."""
    text = "".join(p.read_text() for p in (ROOT / "fmu" / "src").rglob("*.rs"))
    names = sorted(set(re.findall(r"\b(fmi[23][A-Z]\w+)\(", text)))
    source, library = folder / "idle.c", folder / "idle.so"
    body = "static int there;\n"
    for name in names:
        body += f"void *{name}(void) {{ return {'&there' if 'Instantiate' in name else '(void *)0'}; }}\n"
    source.write_text(body)
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", source, "-o", library], check=True)
    copy = folder / f"idle_{Path(fmu).name}"
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(copy, "w") as new:
        for name in old.namelist():
            new.writestr(name, library.read_bytes() if name.endswith(".so") else old.read(name))
    return copy


def slave_of(fmu):
    d = fmpy.read_model_description(str(fmu))
    two = d.fmiVersion == "2.0"
    token = d.guid if two else d.instantiationToken
    folder = fmpy.extract(str(fmu))
    kind = FMU2Slave if two else FMU3Slave
    slave = kind(guid=token, unzipDirectory=folder, modelIdentifier=d.coSimulation.modelIdentifier, instanceName="pad")
    slave.instantiate()
    if two:
        slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    stems = [f"contact.{o}" for o in OUTPUTS]
    variables = [v for v in d.modelVariables if v.name.split("[")[0] in stems]
    count = sum(v.shape[0] if v.dimensions else 1 for v in variables)
    return two, slave, [v.valueReference for v in variables], count, folder


def through_fmpy(fmu, steps):
    """Seconds per step and read of all contact values."""
    two, slave, references, count, _ = slave_of(fmu)
    read = (lambda: slave.getReal(references)) if two else (lambda: slave.getFloat64(references, nValues=count))
    start = time.perf_counter()
    for i in range(steps):
        slave.doStep(currentCommunicationPoint=i * H, communicationStepSize=H)
        read()
    return (time.perf_counter() - start) / steps, count


def bare(fmu, steps):
    """Seconds per step of the C function."""
    two, slave, *_, folder = slave_of(fmu)
    library = CDLL(str(next((Path(folder) / "binaries").rglob("*.so"))))
    instance = c_void_p(slave.component)
    out = [(c_double * 1)() for _ in range(4)]
    if two:
        function = library.fmi2DoStep
        function.argtypes = [c_void_p, c_double, c_double, c_int]
        more = (1,)
    else:
        function = library.fmi3DoStep
        function.argtypes = [c_void_p, c_double, c_double, c_int] + [c_void_p] * 4
        more = (1, *out)
    start = time.perf_counter()
    for i in range(steps):
        function(instance, i * H, H, *more)
    return (time.perf_counter() - start) / steps


def main():
    steps = arguments(__doc__, ("--steps", {"type": int, "default": 2000, "help": "steps of a round"})).steps
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print("FMI values  FMPy floor  with the pad  step itself  (total - step) / floor      us per step")
        for version in ("2", "3"):
            fmu = folder / f"pad{version}.fmu"
            command("fmu", "kazmi2014", "-o", fmu, "--fmi", version)
            nothing = idle(fmu, folder)
            # the least of several rounds: what disturbs only adds
            floor, total, step = (min(f() for _ in range(5)) for f in (
                lambda: through_fmpy(nothing, steps)[0], lambda: through_fmpy(fmu, steps)[0], lambda: bare(fmu, steps) - bare(nothing, steps)))  # fmt: skip
            count = through_fmpy(fmu, steps)[1]
            us = [1e6 * t for t in (floor, total, step)]
            print(f"{version:>3} {count:6}  {us[0]:10.2f}  {us[1]:12.2f}  {us[2]:11.2f}  {(us[1] - us[2]) / us[0]:22.2f}")


if __name__ == "__main__":
    main()
