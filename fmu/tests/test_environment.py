"""The floating-point environment of an importer: it may trap exceptions and round as it likes, and finds it so after every call."""

import subprocess
import sys
from pathlib import Path

import pytest

# an importer of its own: a trap that fires ends the process
PROGRAM = """
import ctypes, sys
from ctypes import c_double
sys.path.insert(0, sys.argv[1])
from raw import OK, Instance, Library

libm = ctypes.CDLL("libm.so.6")
TRAPS, UPWARD, OVERFLOW = 0x1 | 0x4 | 0x8, 0x800, 0x8  # invalid, division by zero, overflow
kind = sys.argv[3]
if kind == "traps":
    assert libm.feenableexcept(TRAPS) >= 0
elif kind == "upward":
    assert libm.fesetround(UPWARD) == 0
elif kind == "flags":
    libm.feclearexcept(0x3D)
    assert libm.feraiseexcept(OVERFLOW) == 0

def unchanged():
    if kind == "traps":
        assert libm.fegetexcept() == TRAPS
    elif kind == "upward":
        assert libm.fegetround() == UPWARD
    elif kind == "flags":
        assert libm.fetestexcept(0x1 | 0x4 | 0x8) == OVERFLOW

library = Library(sys.argv[2])
instance = Instance(library)
unchanged()
instance.start(press=-0.3)
unchanged()
for n in range(20):
    assert instance.set("press", -0.3125 + n / 64) == OK
    assert instance.step(n / 32, 1 / 32) == OK, instance.log
    unchanged()
assert instance.step(-1.0, 1.0) != OK
unchanged()
status, state = instance.save()
assert status == OK and instance.restore(state) == OK
unchanged()
print([x.hex() for x in instance.everything()])
instance.free()
unchanged()
"""


@pytest.mark.parametrize("version", ["2", "3"])
def test_environment_of_the_importer_is_its_own(pack, version):
    fmu = pack("kazmi2014", version)
    outcomes = {}
    for kind in ("default", "traps", "upward", "flags"):
        command = [sys.executable, "-c", PROGRAM, str(Path(__file__).parent), str(fmu), kind]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, (kind, done.returncode, done.stderr)
        outcomes[kind] = done.stdout
    assert "0x" in outcomes["default"]
    assert len(set(outcomes.values())) == 1
