"""Sweeps."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest
from conftest import pad

import stickslip


def test_runs_are_those_of_run() -> None:
    results = stickslip.sweep(
        pad(),
        {"contact.friction.b": [0.0005, 0.002], "run.signals.press": (-0.3, -0.1, 2), "time.step": [0.0625, 0.03125]},
        record=["contact.force", "tip.displacement", "contact.max_slip_rate:max", "press:mean"],
        workers=2,
    )
    assert results.sizes["run"] == 8
    assert (results["error"] == "").all()
    for run in range(8):
        row = results.isel(run=run)
        changes = {path: float(row[path]) for path in ("contact.friction.b", "run.signals.press", "time.step")}
        alone = stickslip.run(stickslip.Scene(pad()).with_(changes))
        assert float(row["contact.force"]) == pytest.approx(float(alone["contact.force"][-1]), rel=1e-9)
        assert float(row["tip.displacement[1]"]) == pytest.approx(float(alone["tip.displacement"][-1, 0]), rel=1e-9)
        assert float(row["contact.max_slip_rate:max"]) == pytest.approx(float(alone["contact.max_slip_rate"].max()), rel=1e-9)
        assert float(row["press:mean"]) == pytest.approx(changes["run.signals.press"])
    assert len(np.unique(results["contact.force"])) == 8


def test_workers_and_endings_do_not_change_the_table(tmp_path: pathlib.Path) -> None:
    vary = {"contact.friction.b": (1e-4, 2e-3, "log"), "contact.friction.alpha": (10.0, 200.0)}

    def sweep(name: str, workers: int, **options: object) -> bytes:
        stickslip.sweep(pad(), vary, sampling="sobol", runs=32, workers=workers, file=tmp_path / name, **options)  # type: ignore[arg-type]
        return (tmp_path / name).read_bytes()

    expected = sweep("one.csv", 1)
    assert sweep("three.csv", 3) == expected
    assert len(expected.splitlines()) == 33

    def stop(done: int, of: int) -> None:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        sweep("cut.csv", 1, progress=stop)
    journal = tmp_path / "cut.csv.part"
    lines = expected.decode().splitlines()
    assert journal.read_text().startswith("# stickslip ")
    # as if the machine had gone down within a row
    rows = ["{},{},".format(n, ",".join(line.split(",")[3:-1])) for n, line in enumerate(lines[1:6])]
    journal.write_text(journal.read_text().splitlines()[0] + "\n" + "\n".join(rows) + "\n5,0.00")
    told: list[int] = []
    assert sweep("cut.csv", 2, resume=True, progress=lambda done, of: told.append(done)) == expected
    assert told[-1] == 32 and not journal.exists()
    journal.write_text("# stickslip 0.0.0 sweep 0\n")
    with pytest.raises(OSError, match="another sweep"):
        sweep("cut.csv", 2, resume=True)


def test_tables(tmp_path: pathlib.Path) -> None:
    vary = {"fidelity.model": ["full", "reduced"], "contact.friction.a": [0.002, 0.003]}
    results = stickslip.sweep(pad(), vary, file=tmp_path / "t.npz", record=["contact.force"])
    with np.load(tmp_path / "t.npz") as table:
        assert list(table["fidelity.model"]) == ['"full"', '"full"', '"reduced"', '"reduced"']
        assert np.array_equal(table["contact.friction.a"], results["contact.friction.a"])
        assert np.array_equal(table["contact.force"], results["contact.force"])
        assert list(table["error"]) == [""] * 4
    force = results["contact.force"].values
    assert force[:2] == pytest.approx(force[2:], rel=1e-6) and force[0] != force[1]
    parquet = pytest.importorskip("pyarrow.parquet")
    stickslip.sweep(pad(), vary, file=tmp_path / "t.parquet", record=["contact.force"])
    read = parquet.read_table(tmp_path / "t.parquet")
    assert read.column_names == ["run", "fidelity.model", "contact.friction.a", "contact.force", "error"]
    assert np.array_equal(read["contact.force"], force)
    assert not list(tmp_path.glob("*.part"))


def test_a_run_that_fails_is_a_row() -> None:
    scene = stickslip.Scene(pad()).with_({"fidelity.solver": {"kind": "newton", "max_iterations": 1}})
    results = stickslip.sweep(scene, {"contact.friction.a": [0.003, 0.1]}, record=["contact.force"])
    failed = results["error"] != ""
    assert failed.any()
    assert np.isnan(results["contact.force"].values[failed]).all()
    assert "did not converge" in str(results["error"].values[failed][0])


def test_what_is_no_sweep_is_refused(tmp_path: pathlib.Path) -> None:
    def refused(path: str, vary: dict[str, object], **options: object) -> None:
        with pytest.raises(stickslip.Error) as caught:
            stickslip.sweep(pad(), vary, **options)  # type: ignore[arg-type]
        assert caught.value.path == path, str(caught.value)

    refused("contact.friction.b", {"contact.friction.b": (-1.0, 1.0, 3)})
    refused("contact.friction.c", {"contact.friction.c": [1.0]})
    refused("contact.friction.b", {"contact.friction.b": []})
    refused("contact.friction.b", {"contact.friction.b": (0.0, 1.0, 3, "log")})
    refused("runs", {"contact.friction.b": (0.1, 1.0)}, sampling="latin")
    refused("sampling", {"contact.friction.b": (0.1, 1.0)}, sampling="random")
    refused("record", {"mesh.cells": [[4, 2], [8, 4]]}, record=["contact.slip"])
    refused("port", {"contact.friction.b": [0.002]}, record=["contact.slips"])
    refused("record", {"contact.friction.b": [0.002]}, record=["contact.slip:median"])
    with pytest.raises(ValueError, match="a range is"):
        stickslip.sweep(pad(), {"contact.friction.b": (1.0,)})
    with pytest.raises(ValueError, match="ends in"):
        stickslip.sweep(pad(), {"contact.friction.b": [0.1]}, file=tmp_path / "t.xls")
