"""`time.tolerance` as a fixed parameter, and `solver.error_estimate` of an FMU whose scene asks for it."""

import json

import pytest
from raw import H, ERROR, Instance, Library, OK
from trajectories import ROOT

ESTIMATE = "solver.error_estimate"


@pytest.fixture
def estimating(pack, version, tmp_path_factory):
    """The paper's example with a tolerance, packed."""
    scene = json.loads((ROOT / "src/scene/examples/kazmi2014.json").read_text())
    scene["time"]["tolerance"] = 1e-2
    path = tmp_path_factory.mktemp("scenes") / "estimating.json"
    path.write_text(json.dumps(scene))
    library = Library(pack(path, version))
    yield library
    library.close()


def run(pad, **parameters):
    for name, value in parameters.items():
        assert pad.set(name.replace("_", "."), value) == OK, pad.log
    pad.start()
    for i in range(8):
        assert pad.step(4 * i * H, 4 * H) == OK, pad.log
    return pad.get("contact.slip_rate")


def error(found, exact):
    return max(abs(a - b) for a, b in zip(found, exact)) / max(map(abs, exact))


def test_tolerance_is_a_parameter(library, pad):
    assert pad.get("time.tolerance") == [0.0]
    assert ESTIMATE not in library.variables
    coarse = run(pad)
    assert pad.reset() == OK and pad.get("time.tolerance") == [0.0]
    fine = run(pad, time_step=1 / 4096)
    assert pad.reset() == OK
    chosen = run(pad, time_tolerance=1e-6)
    assert pad.get("time.tolerance") == [1e-6]
    assert error(chosen, fine) < 0.1 * error(coarse, fine)


def test_estimate_is_an_output_where_the_scene_asks(estimating):
    assert estimating.variables[ESTIMATE].causality == "output"
    pad = Instance(estimating)
    assert pad.get("time.tolerance") == [1e-2] and pad.get(ESTIMATE) == [0.0]
    run(pad)
    loose = pad.get(ESTIMATE)[0]
    assert pad.reset() == OK
    run(pad, time_tolerance=1e-4)
    assert 0.0 < pad.get(ESTIMATE)[0] < loose < 1e-2
    # without a tolerance the output stays, by the second solution beside equal steps
    assert pad.reset() == OK
    run(pad, time_tolerance=0.0)
    assert 0.0 < pad.get(ESTIMATE)[0] < 1e-2
    pad.free()


def test_states_carry_the_control(estimating):
    pad = Instance(estimating)
    run(pad, time_tolerance=1e-5)
    status, state = pad.save()
    assert status == OK
    status, data = pad.serialize(state)
    assert status == OK
    assert pad.step(32 * H, H) == OK
    ahead = pad.everything()
    other = Instance(estimating)
    status, copy = other.deserialize(data)
    assert status == OK and other.restore(copy) == OK
    assert other.step(32 * H, H) == OK
    assert other.everything() == ahead
    assert other.drop(copy) == OK and pad.drop(state) == OK
    other.free()
    pad.free()


@pytest.mark.parametrize("tolerance, scheme, path", [(2.0, 1, "time.tolerance"), (-1.0, 1, "time.tolerance"), (1e-3, 2, "time.tolerance")])
def test_tolerance_is_refused_with_its_path(pad, tolerance, scheme, path):
    assert pad.set("time.tolerance", tolerance) == OK and pad.choice("time.scheme", scheme) == OK
    assert pad.setup() == OK and pad.enter() == ERROR
    assert any(path in message for _, _, _, message in pad.log), pad.log
    assert pad.set("time.tolerance", 0.0) == OK and pad.enter() == OK
