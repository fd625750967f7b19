"""An FMU whose mesh is a file: it carries the file, and compiles from it when a fixed parameter was set."""

import json
import shutil
import zipfile
from pathlib import Path

import pytest
from raw import H, Instance, Library, OK

SHOE = Path(__file__).parents[2] / "tests" / "meshes" / "shoe.bin.msh"
MATERIAL = {"viscosity": {"law": "isotropic", "mu1": 5e4, "mu2": 1e5},
            "elasticity": {"law": "isotropic", "young": 2e7, "poisson": 0.3, "convention": "plane_strain"}}
YOUNG = "materials[1].elasticity.young"


def scene(young):
    lining = json.loads(json.dumps(MATERIAL))
    lining["elasticity"]["young"] = young
    return {"schema_version": 1, "name": "shoe", "mesh": {"kind": "gmsh", "file": "mesh/shoe.msh"},
            "materials": [{"region": "rim", **MATERIAL}, {"region": "lining", **lining}],
            "clamped": ["pivot"], "contact": {"part": "drum face", "friction": {"law": "tresca", "bound": 2e4}},
            "loads": [{"name": "cam", "kind": "traction", "part": "cam", "direction": [1, -1], "start": 4e5}],
            "time": {"step": H}, "run": {"until": 8 * H}}


@pytest.fixture
def shoe(tmp_path, pack, version):
    """Packs the shoe; the scene and its mesh are gone before the FMU is used."""

    def make(young):
        folder = tmp_path / f"{young:g}"
        (folder / "mesh").mkdir(parents=True)
        shutil.copy(SHOE, folder / "mesh" / "shoe.msh")
        path = folder / f"shoe_{young:g}.json"
        path.write_text(json.dumps(scene(young)))
        packed = pack(path, version)
        shutil.rmtree(folder)
        return packed

    return make


def run(fmu, young=None):
    library = Library(fmu)
    shoe = Instance(library)
    if young is not None:
        assert shoe.set(YOUNG, young) == OK, shoe.log
    shoe.start()
    for i in range(8):
        assert shoe.step(i * H, H) == OK, shoe.log
    end = shoe.everything()
    shoe.free()
    library.close()
    return end


def test_the_mesh_travels_with_the_fmu(shoe):
    soft, stiff = shoe(1e7), shoe(2e7)
    with zipfile.ZipFile(soft) as archive:
        assert archive.read("resources/mesh/shoe.msh") == SHOE.read_bytes()
    own, other = run(stiff), run(soft)
    assert own != other
    # compiled again in initialization, from the mesh that it carries: the bits of the other FMU
    assert run(soft, 2e7) == own
