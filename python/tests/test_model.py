"""Compilation and what a model tells."""

from __future__ import annotations

import pathlib
import pickle

import numpy as np
import pytest
from conftest import pad

import stickslip


def test_compilation_tells_where_it_stands() -> None:
    told: list[tuple[str, float]] = []
    stickslip.compile(pad(), progress=lambda phase, fraction: told.append((phase, fraction)))
    fractions = [fraction for _, fraction in told]
    assert len(told) > 5
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert {"assembly", "model of the body", "certificate"} <= {phase for phase, _ in told}


def test_compilation_is_stopped_by_its_observer() -> None:
    with pytest.raises(stickslip.Error) as caught:
        stickslip.compile(pad(), progress=lambda phase, fraction: fraction < 0.1)
    assert caught.value.code is stickslip.ErrorCode.CANCELLED

    def fail(phase: str, fraction: float) -> None:
        raise KeyError(phase)

    with pytest.raises(KeyError, match="assembly"):
        stickslip.compile(pad(), progress=fail)


def test_info_and_certificate(model: stickslip.Model) -> None:
    info = model.info
    assert (info["dimension"], info["mesh_nodes"], info["contact_nodes"]) == (2, 45 + 32, 8)
    assert 0 < info["rates"][0] < info["rates"][1]
    assert info["largest_step"] == 0.0625
    assert info["state_bytes"] == len(stickslip.Simulator(model).save().to_bytes())
    assert model.certificate["sharp_step"]
    assert model.certificate["largest_pressure"] is None


def test_ports(model: stickslip.Model) -> None:
    names = [port.name for port in model.ports]
    assert [port.reference for port in model.ports] == list(range(len(names)))
    slip_rate = model.port("contact.slip_rate")
    assert (slip_rate.unit, slip_rate.causality, slip_rate.shape) == ("m/s", "output", (8,))
    assert model.port(slip_rate.reference).name == "contact.slip_rate"
    assert slip_rate.description
    for wrong in ("contact.sliprate", 10_000):
        with pytest.raises(stickslip.Error) as caught:
            model.port(wrong)
        assert caught.value.code is stickslip.ErrorCode.UNKNOWN


def test_contact_geometry(model: stickslip.Model, solid: stickslip.Model, brake: stickslip.Model) -> None:
    contact = model.contact
    assert contact["position"].shape == (8, 2)
    assert (contact["position"][:, 1] == 0).all()
    # the share of the clamped corner belongs to no one
    assert contact["weight"].sum() == pytest.approx(1 - 1 / 16)
    assert (contact["tangent"] == [[1, 0]]).all()
    assert "gap" not in contact
    nodes = len(solid.contact["node"])
    assert solid.contact["tangent"].shape == (nodes, 2, 3)
    assert brake.contact["gap"] == pytest.approx(np.full(9, 2e-5))
    assert (brake.contact["normal"] == [0, 1]).all()


def test_matrices_step_the_body(model: stickslip.Model) -> None:
    """The displacement under a steady load without slip, from the matrices alone: `0 = -rates q + contact.T f + outputs.T p`."""
    matrices = model.matrices()
    assert matrices is not None
    rates, contact, outputs = matrices["rates"], matrices["contact"], matrices["outputs"]
    assert (np.diff(rates) >= 0).all() and outputs.shape == (len(rates), 1 + 2)
    scene = model.scene.with_({"contact.friction": {"law": "tresca", "bound": 1e3}, "run.signals": {"press": -0.3}})
    tresca = stickslip.compile(scene)
    held = stickslip.Simulator(tresca)
    held.init()
    for _ in range(40):
        held.step(0.5)
    assert held["contact.stick_fraction"] == 1.0
    own = tresca.matrices()
    assert own is not None
    rates, contact, outputs = own["rates"], own["contact"], own["outputs"]
    # contact forces that keep q.contact = 0
    compliance = contact.T @ (contact / rates[:, None])
    load = -0.3 * outputs[:, 0]
    forces = np.linalg.solve(compliance, -contact.T @ (load / rates))
    modes = (load + contact @ forces) / rates
    assert outputs[:, 0] @ modes == pytest.approx(held["press.displacement"] * 1.0, rel=1e-6)
    stress = forces / tresca.contact["weight"]
    assert stress == pytest.approx(held["contact.tangential_stress"], rel=1e-5, abs=1e-8)
    condensed = stickslip.compile(model.scene.with_({"fidelity.model": "condensed"}))
    assert condensed.matrices() is None


def test_bytes_hold_the_model(model: stickslip.Model, tmp_path: pathlib.Path) -> None:
    model.save(tmp_path / "pad.model")
    for same in (
        stickslip.Model.load(tmp_path / "pad.model"),
        stickslip.Model.from_bytes(model.to_bytes()),
        pickle.loads(pickle.dumps(model)),
    ):
        assert same == model and hash(same) == hash(model)
        assert same.to_bytes() == model.to_bytes()
    assert pickle.loads(pickle.dumps(model)).scene == model.scene
    damaged = bytearray(model.to_bytes())
    damaged[100] ^= 1
    with pytest.raises(stickslip.Error) as caught:
        stickslip.Model.from_bytes(bytes(damaged))
    assert caught.value.code is stickslip.ErrorCode.BYTES


def test_fields_are_those_of_the_ports(model: stickslip.Model, simulator: stickslip.Simulator) -> None:
    state = simulator.save()
    mesh = model.mesh()
    tip = np.flatnonzero((mesh["points"] == [1.0, 0.0]).all(axis=1))
    for of in (model, stickslip.Model.from_bytes(model.to_bytes())):
        displacement, velocity = of.displacement(state), of.velocity(state)
        assert displacement.shape == mesh["points"].shape
        assert displacement[tip[0]] == pytest.approx(simulator["tip.displacement"], rel=1e-6)
        assert velocity[tip[0]] == pytest.approx(simulator["tip.velocity"], rel=1e-6)
        assert velocity[model.contact["node"], 0] == pytest.approx(simulator["contact.slip_rate"], rel=1e-6, abs=1e-9)
    assert abs(simulator["tip.displacement"][0]) > 1e-3
