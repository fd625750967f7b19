"""Stepping, setting, reading, saving, derivatives."""

from __future__ import annotations

import copy
import ctypes
import gc
import pickle
import platform
import sys
from typing import Any

import numpy as np
import pytest

import stickslip


def test_values_are_set_and_read(model: stickslip.Model) -> None:
    simulator = stickslip.Simulator(model)
    simulator["press"] = -0.25
    assert simulator["press"] == simulator.get(0) == -0.25
    simulator.set({"press": -0.2, "contact.friction.b": 0.002})
    assert (simulator["press"], simulator["contact.friction.b"]) == (-0.2, 0.002)
    simulator.set_inputs([-0.3])
    simulator.set_inputs(np.array([-0.3], dtype=np.float32))
    simulator.set_inputs({"press": -0.31})
    assert simulator["press"] == -0.31
    assert isinstance(simulator["contact.stick_fraction"], float)
    assert simulator["contact.slip_rate"].shape == (8,)
    unpacked = model.unpack(simulator.outputs())
    for port in model.ports:
        if port.causality == "output":
            assert np.array_equal(unpacked[port.name], simulator[port.name]), port.name


def refused(call: Any, *arguments: Any) -> stickslip.Error:
    with pytest.raises(stickslip.Error) as caught:
        call(*arguments)
    return caught.value


def test_refusals_leave_everything_as_it_was(simulator: stickslip.Simulator) -> None:
    before = simulator.save()
    code = stickslip.ErrorCode
    error = refused(simulator.step, -1.0)
    assert (error.code, error.found) == (code.STEP, -1.0)
    error = refused(simulator.step, 0.1, 0.5)
    assert (error.code, error.found, error.allowed) == (code.STEP, 0.5, 0.1)
    assert refused(simulator.init).code is code.CALL_ORDER
    assert refused(simulator.set, "press", float("nan")).code is code.VALUE
    assert refused(simulator.set, "contact.slip_rate", 1.0).code is code.CALL_ORDER
    error = refused(simulator.set_inputs, [1.0, 2.0])
    assert (error.code, error.found, error.allowed) == (code.LENGTH, 2, 1)
    assert refused(simulator.set_inputs, {"contact.slip": 1.0}).code is code.UNKNOWN
    assert refused(simulator.set, {"press": 1.0, "contact.friction.a": 0.0}).code is code.VALUE
    assert refused(simulator.slip_history, 8).code is code.UNKNOWN
    with pytest.raises(ValueError, match="expected numbers"):
        simulator.set_inputs(["a"])
    with pytest.raises(TypeError):
        simulator.set("press")
    assert simulator.save() == before
    assert refused(stickslip.Simulator(simulator.model).step, 0.1).code is code.CALL_ORDER


def test_inputs_mean_what_is_asked(model: stickslip.Model) -> None:
    slips = []
    for meaning in ("end_of_step", "hold", "continue"):
        simulator = stickslip.Simulator(model, inputs=meaning)
        simulator.init()
        for press in (-0.2, -0.4, -0.1):
            simulator["press"] = press
            simulator.step(0.1)
        slips.append(simulator["contact.slip"][-1])
    assert len(set(slips)) == 3
    with pytest.raises(stickslip.Error, match="continue"):
        stickslip.Simulator(model, inputs="begin")  # type: ignore[arg-type]
    sloped, stepped = stickslip.Simulator(model), stickslip.Simulator(model)
    for simulator in (sloped, stepped):
        simulator.init()
    sloped.set_input_slope("press", 1.0)
    sloped.step(0.1)
    stepped["press"] = -0.2
    stepped.step(0.1)
    assert sloped["contact.slip"] == pytest.approx(stepped["contact.slip"], rel=1e-12)
    sloped.jump_inputs([-0.1])
    assert sloped["press"] == -0.1


def test_a_view_is_always_of_now(model: stickslip.Model) -> None:
    simulator = stickslip.Simulator(model)
    views = {name: simulator.view(name) for name in ("contact.slip_rate", "energy.external_work", "press", "tip.displacement")}
    assert simulator.view("press") is views["press"]

    def check() -> None:
        for name, view in views.items():
            assert np.array_equal(view, simulator[name]), name

    check()
    simulator.init()
    check()
    start = simulator.save()
    address = views["contact.slip_rate"].ctypes.data
    for _ in range(4):
        before = views["contact.slip_rate"].copy()
        simulator.step(0.1)
        assert not np.array_equal(before, views["contact.slip_rate"])
        check()
    simulator["press"] = 0.0
    check()
    simulator.restore(start)
    check()
    simulator.reset()
    check()
    assert views["contact.slip_rate"].ctypes.data == address
    with pytest.raises(ValueError):
        views["press"][...] = 1.0
    kept = views["contact.slip_rate"]
    last = kept.copy()
    del simulator, views
    gc.collect()
    assert np.array_equal(kept, last)


def trajectory(simulator: stickslip.Simulator) -> list[bytes]:
    rows = []
    for press in (-0.3, -0.25, -0.2, -0.15, -0.1):
        simulator["press"] = press
        simulator.step(0.07)
        rows.append(simulator.outputs().tobytes())
    return rows


def test_states_bring_a_simulation_back_bit_for_bit(simulator: stickslip.Simulator) -> None:
    state = simulator.save()
    expected = trajectory(simulator)
    moved = simulator["contact.slip_rate"]
    assert abs(moved).max() > 1e-6
    into = stickslip.Simulator(simulator.model).save()
    simulator.restore(state)
    assert simulator.save(into) is into and into == state and into.time == state.time == 0.1
    for again in (state, pickle.loads(pickle.dumps(state)), stickslip.State.from_bytes(state.to_bytes())):
        assert again == state
        simulator.restore(again)
        assert trajectory(simulator) == expected
    simulator.restore(state)
    for other in (simulator.copy(), copy.deepcopy(simulator), pickle.loads(pickle.dumps(simulator))):
        assert trajectory(other) == expected
    assert simulator.time == 0.1
    assert trajectory(simulator) == expected


def test_states_of_other_models_are_refused(simulator: stickslip.Simulator, brake: stickslip.Model) -> None:
    other = stickslip.Simulator(brake).save()
    for state in (other, pickle.loads(pickle.dumps(other))):
        assert refused(simulator.restore, state).code is stickslip.ErrorCode.FINGERPRINT
    assert refused(simulator.save, other).code is stickslip.ErrorCode.FINGERPRINT
    damaged = simulator.save().to_bytes()[:-1]
    assert refused(stickslip.State.from_bytes, damaged).code is stickslip.ErrorCode.BYTES


def test_derivatives_are_those_of_differences(brake: stickslip.Model) -> None:
    simulator = stickslip.Simulator(brake)
    simulator.init()
    for piston in (0.001, 0.002, 0.002):
        simulator.set_inputs({"piston": piston, "disc": 5.0})
        simulator.step(0.02)
    state = simulator.save()

    def after(disc: float) -> Any:
        simulator.restore(state)
        simulator.set_inputs({"piston": 0.002, "disc": disc})
        simulator.step(0.02)
        return simulator.outputs()

    after(5.0)
    tangent = simulator.directional_derivative({"disc": 1.0})
    by_all = simulator.directional_derivative([0.0, 0.0, 1.0])
    assert np.array_equal(tangent, by_all)
    difference = brake.unpack((after(5.01) - after(4.99)) / 0.02)
    for name in ("contact.slip_rate", "contact.tangential_stress", "disc.torque"):
        found = brake.unpack(tangent)[name]
        assert found == pytest.approx(difference[name], rel=1e-3, abs=1e-3 * float(np.max(np.abs(difference[name]))))
    assert abs(brake.unpack(tangent)["disc.torque"]) > 1e-3
    after(5.0)
    adjoint = simulator.adjoint_derivative({"disc.torque": 1.0})
    assert adjoint[list(brake.scene.inputs).index("disc")] == pytest.approx(float(brake.unpack(tangent)["disc.torque"]), rel=1e-9)
    simulator.restore(state)
    assert refused(simulator.directional_derivative, [0.0, 0.0, 1.0]).code is stickslip.ErrorCode.CALL_ORDER
    assert abs(simulator.directional_derivative({"disc": 1.0}, instant=True)).max() > 0
    with pytest.raises(KeyError):
        simulator.adjoint_derivative({"press": 1.0} if "press" in brake.scene.inputs else {"disc": 1.0})


def test_history_is_the_past(simulator: stickslip.Simulator) -> None:
    rows = [(simulator.time, float(simulator["contact.slip"][3]))]
    for _ in range(3):
        simulator.step(0.0625)
        rows.append((simulator.time, float(simulator["contact.slip"][3])))
    history = simulator.slip_history(3)
    assert history["slip"].shape == (len(history["time"]), 1)
    found = dict(zip(history["time"], history["slip"][:, 0]))
    for time, slip in rows:
        assert found[time] == slip
    assert simulator.work["internal_steps"] == 5
    assert simulator.work["factorizations"] >= 1


@pytest.mark.skipif(platform.machine() != "x86_64" or sys.platform != "linux", reason="numbers of the rounding modes")
def test_results_do_not_depend_on_the_rounding_of_the_host(simulator: stickslip.Simulator) -> None:
    state = simulator.save()
    expected = trajectory(simulator)
    simulator.restore(state)
    libm = ctypes.CDLL("libm.so.6")
    upward = 0x800
    assert libm.fesetround(upward) == 0
    try:
        found = trajectory(simulator)
        assert libm.fegetround() == upward
    finally:
        libm.fesetround(0)
    assert found == expected


def test_representations(simulator: stickslip.Simulator) -> None:
    assert repr(simulator) == '<Simulator of "pad" at 0.1 s>'
    assert repr(simulator.save()) == "<State at 0.1 s>"
    assert repr(simulator.model).startswith('<Model "pad": ')
    assert repr(simulator.model.scene) == '<Scene "pad">'


def test_cycles_of_saving_do_not_grow(simulator: stickslip.Simulator) -> None:
    """Saving, restoring, pickling and copying give back all that they take."""

    def resident() -> int:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * 4096

    def cycle(times: int) -> None:
        for _ in range(times):
            state = simulator.save()
            simulator.restore(pickle.loads(pickle.dumps(state)))
            simulator.step(0.01)
            simulator.restore(state)
            simulator.copy().view("contact.slip_rate")

    cycle(500)
    before = resident()
    cycle(2000)
    # a state is 10 kB: what was lost would be 20 MB
    assert resident() - before < 4_000_000
