"""Builds the wheel: maturin, and beside the extension module the FMU library, which is compiled with it.

`pip` calls these functions (PEP 517). Cargo makes the FMU library as a dependency of the module, but only maturin knows what goes
into the wheel, and only cargo where the library lies: so cargo is asked first, and the file is laid where `tool.maturin.include`
finds it. Both builds are of the same packages, so nothing is compiled twice.
"""

import json
import pathlib
import shutil
import subprocess

import maturin
from maturin import get_requires_for_build_editable, get_requires_for_build_sdist, get_requires_for_build_wheel  # noqa: F401
from maturin import build_sdist, prepare_metadata_for_build_editable, prepare_metadata_for_build_wheel  # noqa: F401

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIBRARIES = ROOT / "python" / "stickslip" / "lib"


def stage_fmu_library():
    """Builds the FMU library and copies it into the package."""
    command = ["cargo", "build", "--release", "--locked", "-p", "stickslip-python", "-p", "stickslip-fmu"]
    built = subprocess.run([*command, "--message-format=json-render-diagnostics"], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    for line in built.stdout.splitlines():
        message = json.loads(line)
        if message.get("reason") != "compiler-artifact" or message["target"]["name"] != "stickslip_fmu":
            continue
        for file in map(pathlib.Path, message["filenames"]):
            if file.suffix in (".so", ".dylib", ".dll"):
                LIBRARIES.mkdir(exist_ok=True)
                shutil.copyfile(file, LIBRARIES / file.name)
                return
    raise RuntimeError("cargo built no FMU library")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    stage_fmu_library()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    stage_fmu_library()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)
