"""FMUs for the tests: packed once by the command `stickslip`, whose folder STICKSLIP_BUILD names."""

import json
import os
import subprocess
from pathlib import Path

import pytest
from raw import Instance, Library
from trajectories import SCENES

BUILD = Path(os.environ.get("STICKSLIP_BUILD", Path(__file__).parents[2] / "target" / "release"))


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="session")
def pack(tmp_path_factory):
    folder, packed = tmp_path_factory.mktemp("fmus"), {}

    def make(scene, kind):
        """kind: "2", "3" or "3 scalar"."""
        key = (str(scene), kind)
        if key not in packed:
            path = folder / f"{Path(str(scene)).stem}_{kind.replace(' ', '_')}.fmu"
            version, *scalar = kind.split()
            run(BUILD / "stickslip", "fmu", scene, "-o", path, "--fmi", version, *(f"--{s}" for s in scalar))
            packed[key] = path
        return packed[key]

    return make


@pytest.fixture(scope="session")
def pack_trajectory(pack, tmp_path_factory):
    folder = tmp_path_factory.mktemp("scenes")

    def make(name, kind):
        path = folder / f"{name}.json"
        path.write_text(json.dumps(SCENES[name]))
        return pack(path, kind)

    return make


@pytest.fixture(params=["2", "3"])
def version(request):
    return request.param


@pytest.fixture
def paper(pack, version):
    return pack("kazmi2014", version)


@pytest.fixture
def library(paper):
    library = Library(paper)
    yield library
    library.close()


@pytest.fixture
def pad(library):
    pad = Instance(library)
    yield pad
    pad.free()
