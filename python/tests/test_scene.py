"""Where scenes come from, how they change, and how they travel."""

from __future__ import annotations

import json
import pathlib
import pickle
import re
import sys

import numpy as np
import pytest
from conftest import pad

import stickslip


def test_one_scene_comes_in_every_form(tmp_path: pathlib.Path) -> None:
    from_dict = stickslip.Scene(pad())
    text = json.dumps(pad())
    path = tmp_path / "pad.json"
    path.write_text("\ufeff" + text, encoding="utf-8")
    for same in (text, "  " + text, path, str(path), from_dict, from_dict.to_dict(), from_dict.to_json()):
        assert stickslip.Scene(same) == from_dict
    assert stickslip.Scene("kazmi2014") != from_dict
    assert "kazmi2014" in stickslip.example_names()
    assert json.loads(stickslip.json_schema())["properties"]["contact"]


def test_what_is_no_scene_says_what_would_be_one(tmp_path: pathlib.Path) -> None:
    with pytest.raises(FileNotFoundError, match="kazmi2014"):
        stickslip.Scene("kazmi")
    with pytest.raises(TypeError, match="dict"):
        stickslip.Scene(3)  # type: ignore[arg-type]
    (tmp_path / "latin.json").write_bytes(b'{"name": "\xe9"}')
    with pytest.raises(UnicodeDecodeError):
        stickslip.Scene(tmp_path / "latin.json")
    with pytest.raises(TypeError, match="a scene has no object"):
        stickslip.Scene(pad(name=object()))


def test_values_are_replaced_by_paths() -> None:
    scene = stickslip.Scene(pad())
    changed = scene.with_({"loads[0].start": np.float64(-0.25)}, contact__friction__alpha=np.int64(50), mesh__cells=np.array([4, 2]))
    assert changed["loads[0].start"] == -0.25
    assert changed["contact.friction.alpha"] == 50
    assert changed["mesh.cells"] == [4, 2]
    assert scene["contact.friction.alpha"] == 100
    assert scene.with_({"name": "12"}).name == "12"
    with pytest.raises(stickslip.Error) as caught:
        scene["contact.friction.mu"]
    assert caught.value.code is stickslip.ErrorCode.UNKNOWN


@pytest.mark.parametrize(
    ("changes", "path", "allowed"),
    [
        ({"contact.friction.alpha": -1}, "contact.friction.alpha", "0"),
        ({"contact.frictions": 1}, "contact.frictions", "friction"),
        ({"time.step": float("nan")}, "time.step", "number"),
        ({"clamped": ["lef"]}, "clamped[0]", "left"),
    ],
)
def test_errors_name_the_place(changes: dict[str, object], path: str, allowed: str) -> None:
    with pytest.raises(stickslip.Error) as caught:
        stickslip.Scene(pad(), name="pad.json").with_(changes)
    error = caught.value
    assert error.code is stickslip.ErrorCode.SCENE and int(error.code) == -1
    assert error.path == path
    assert allowed in str(error.allowed)
    assert str(error).startswith("pad.json: at ")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.code, copy.path, copy.found, copy.allowed) == (
        str(error),
        error.code,
        error.path,
        error.found,
        error.allowed,
    )


def test_error_codes_are_known_to_type_checkers() -> None:
    source = pathlib.Path(str(sys.modules["stickslip._error"].__file__)).read_text(encoding="utf-8")
    listed = {name: int(number) for name, number in re.findall(r"^        ([A-Z_]+) = (-\d+)$", source, re.MULTILINE)}
    assert listed == {code.name: code.value for code in stickslip.ErrorCode}
    assert pickle.loads(pickle.dumps(stickslip.ErrorCode.SCENE)) is stickslip.ErrorCode.SCENE


MESH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "left"
1 2 "bottom"
2 3 "body"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1 0 0
3 2 0 0
4 0 1 0
5 1 1 0
6 2 1 0
$EndNodes
$Elements
7
1 1 2 1 1 4 1
2 1 2 2 2 1 2
3 1 2 2 2 2 3
4 2 2 3 3 1 2 5
5 2 2 3 3 1 5 4
6 2 2 3 3 2 3 6
7 2 2 3 3 2 6 5
$EndElements
"""


def test_a_mesh_file_travels_with_its_scene(tmp_path: pathlib.Path) -> None:
    scene = pad(mesh={"kind": "gmsh", "file": "part.msh"}, loads=[], probes=[], run={})
    (tmp_path / "part.msh").write_text(MESH)
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    sources = [
        stickslip.Scene(tmp_path / "scene.json"),
        stickslip.Scene(scene, folder=tmp_path),
        stickslip.Scene(scene, files={"part.msh": MESH.encode()}),
        pickle.loads(pickle.dumps(stickslip.Scene(scene, folder=tmp_path))),
    ]
    models = [stickslip.compile(source) for source in sources]
    assert len({model.fingerprint for model in models}) == 1
    assert len(models[0].contact["node"]) == 2
    (tmp_path / "part.msh").unlink()
    again = pickle.loads(pickle.dumps(models[0]))
    assert again.mesh()["points"].shape == (6, 2)
    with pytest.raises(stickslip.Error) as caught:
        pickle.dumps(stickslip.Scene(scene, folder=tmp_path))
    assert caught.value.path == "mesh.file"
