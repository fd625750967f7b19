"""Runs as Datasets, the same bits as the command, meshes, FMUs."""

from __future__ import annotations

import csv
import pathlib
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from conftest import pad

import stickslip


def command(*arguments: str, cwd: pathlib.Path) -> str:
    done = subprocess.run([sys.executable, "-m", "stickslip", *arguments], cwd=cwd, check=True, capture_output=True, text=True)
    return done.stdout


@pytest.mark.parametrize("name", ["pad", "kazmi2014", "disc_brake", "brake_pad_3d"])
def test_the_command_gives_the_same_bits(name: str, tmp_path: pathlib.Path) -> None:
    scene = stickslip.Scene(pad() if name == "pad" else name)
    if name == "brake_pad_3d":
        scene = scene.with_({"mesh.cells": [4, 2, 3], "run.until": 0.3})
    (tmp_path / "scene.json").write_text(scene.to_json())
    command("run", "scene.json", "--csv", "out.csv", cwd=tmp_path)
    with open(tmp_path / "out.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    results = stickslip.run(scene)
    nodes = results.sizes["node"]
    assert len(rows) == results.sizes["time"] * nodes
    assert [float(row["time"]) for row in rows[::nodes]] == list(results["time"].values)
    for column, port in (
        ("accumulated_slip", "contact.accumulated_slip"),
        ("slip_rate", "contact.slip_rate"),
        ("slip", "contact.slip"),
        ("tangential_stress", "contact.tangential_stress"),
        ("pressure", "contact.pressure"),
        ("gap", "contact.gap"),
    ):
        for written in (column, f"{column}_1", f"{column}_2"):
            if written not in rows[0]:
                continue
            found = results[port].values.reshape(len(rows), -1)[:, 1 if written.endswith("_2") else 0]
            assert [float(row[written]) for row in rows] == list(found), written
    assert abs(results["contact.slip_rate"]).max() > 1e-6


def test_a_run_is_labelled(solid: stickslip.Model) -> None:
    results = stickslip.run(solid, fields=True)
    rate = results["contact.slip_rate"]
    assert rate.dims == ("time", "node", "tangent")
    assert (rate.units, results["time"].units) == ("m/s", "s")
    assert results["contact.force"].dims == ("time", "tangent")
    assert np.array_equal(np.stack([results[axis] for axis in "xyz"], axis=1), solid.contact["position"])
    assert results["weight"].units == "m2"
    assert results["displacement"].dims == ("time", "mesh_node", "axis")
    assert list(results["axis"].values) == ["x", "y", "z"]
    assert abs(results["displacement"]).max() > 0
    assert stickslip.Scene(results.attrs["scene"]) == solid.scene


def test_a_run_is_changed_and_continued(model: stickslip.Model) -> None:
    whole = stickslip.run(model, step=0.125)
    simulator = stickslip.Simulator(model)
    told: list[tuple[int, int]] = []
    first = stickslip.run(simulator, until=0.5, step=0.125, progress=lambda *now: told.append(now))
    assert told[-1] == (4, 4)
    state = simulator.save()
    rest = stickslip.run(simulator, step=0.125)
    again = stickslip.run(model, step=0.125, state=state)
    assert rest.identical(again)
    # the signal jumps at 0.5: the first part ends before the jump, the rest begins behind it
    slip = np.concatenate([first["contact.slip"], rest["contact.slip"][1:]])
    assert np.array_equal(slip, whole["contact.slip"])
    steady = stickslip.run(model, signals={"press": -0.2}, outputs=["press", "contact.slip"])
    assert set(steady.data_vars) == {"press", "contact.slip"}
    assert (steady["press"] == -0.2).all()

    def stop(passed: int, count: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        stickslip.run(model, progress=stop)
    with pytest.raises(stickslip.Error) as caught:
        stickslip.run(model, until=-1)
    assert caught.value.path == "run.until"


def test_meshes(model: stickslip.Model, simulator: stickslip.Simulator, tmp_path: pathlib.Path) -> None:
    meshio = pytest.importorskip("meshio")
    mesh = stickslip.to_meshio(model, simulator, {"one": np.ones(77)})
    mesh.write(tmp_path / "pad.vtu")
    back = meshio.read(tmp_path / "pad.vtu")
    assert np.array_equal(back.points[:, :2], model.mesh()["points"])
    assert np.array_equal(back.cells_dict["triangle"], model.mesh()["cells"])
    assert np.array_equal(back.point_data["displacement"][:, :2], model.displacement(simulator.save()))
    stress = back.point_data["contact.tangential_stress"]
    assert np.array_equal(stress[model.contact["node"]], simulator["contact.tangential_stress"])
    assert np.isnan(stress).sum() == len(stress) - 8
    assert set(stickslip.to_meshio(model).point_data) == set()


def test_an_absent_package_is_named(monkeypatch: pytest.MonkeyPatch, model: stickslip.Model) -> None:
    for name, call in (
        ("xarray", lambda: stickslip.run(model)),
        ("meshio", lambda: stickslip.to_meshio(model)),
        ("pyvista", lambda: stickslip.to_pyvista(model)),
    ):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(ImportError, match=f"needs the package {name}: pip install"):
            call()


def test_fmus(tmp_path: pathlib.Path) -> None:
    content = stickslip.pack_fmu(pad(), tmp_path / "sub" / "pad.fmu", fmi=2)
    assert (tmp_path / "sub" / "pad.fmu").read_bytes() == content
    with zipfile.ZipFile(tmp_path / "sub" / "pad.fmu") as fmu:
        names = fmu.namelist()
        assert 'fmiVersion="2.0"' in fmu.read("modelDescription.xml").decode()
    assert any(name.startswith("binaries/") for name in names)
    fmpy = pytest.importorskip("fmpy")
    results = fmpy.simulate_fmu(str(tmp_path / "sub" / "pad.fmu"), stop_time=0.25, output=["tip.displacement[1]"])
    assert abs(results["tip.displacement[1]"][-1]) > 1e-3
    with pytest.raises(ValueError, match="allowed: 2, 3"):
        stickslip.pack_fmu(pad(), fmi=1)
    with pytest.raises(ValueError, match="arrays"):
        stickslip.pack_fmu(pad(), fmi=2, scalar=True)
    with pytest.raises(OSError):
        stickslip.pack_fmu(pad(), library=tmp_path / "none.so")


def test_a_friction_curve_in_twenty_lines(tmp_path: pathlib.Path) -> None:
    """The example: from a mesh file to a curve that is the law of Stribeck that the scene has."""
    root = pathlib.Path(__file__).resolve().parents[2]
    script = root / "python" / "examples" / "friction_curve.py"
    assert len(script.read_text(encoding="utf-8").splitlines()) <= 20
    mesh = root / "tests" / "meshes" / "shoe.msh"
    done = subprocess.run([sys.executable, str(script), str(mesh)], cwd=tmp_path, check=True, capture_output=True, text=True)
    rows = [line.split() for line in done.stdout.splitlines()]
    speeds, friction = (np.array([float(row[i]) for row in rows]) for i in (0, 2))
    assert speeds[0] == pytest.approx(5.6) and speeds[-1] < 0.5
    assert (np.diff(friction) >= 0).all() and friction[-1] > 0.38
    # all of the face slips nearly at the speed of the drum
    assert friction == pytest.approx(0.3 + 0.15 * np.exp(-speeds / 0.5), rel=2e-3)


def test_the_command_is_there(tmp_path: pathlib.Path) -> None:
    (tmp_path / "pad.json").write_text(stickslip.Scene(pad()).to_json())
    assert "valid" in command("check", "pad.json", cwd=tmp_path)
    assert "FMI 3.0" in command("fmu", "pad.json", "-o", "pad.fmu", cwd=tmp_path)
    assert zipfile.is_zipfile(tmp_path / "pad.fmu")
    wrong = subprocess.run([sys.executable, "-m", "stickslip", "run", "none"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 1 and "none" in wrong.stderr
    usage = subprocess.run([sys.executable, "-m", "stickslip", "--nonsense"], capture_output=True, text=True, check=False)
    assert usage.returncode == 2
