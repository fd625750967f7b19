"""What inputs mean: u is the load at the communication point at which it is set, continued with a slope; `time.inputs` for others."""

import json

import pytest
from raw import DISCARD, ERROR, H, OK, Instance, Library
from trajectories import ROOT

STEP = 1 / 8


@pytest.fixture
def rubbing(pack, tmp_path):
    """A library of the paper's example under constant friction, from rest; its load of the kind asked for."""
    made = []

    def make(kind, version="2"):
        scene = json.loads((ROOT / "src/scene/examples/kazmi2014.json").read_text())
        scene["contact"]["friction"] = {"law": "tresca", "bound": 0.002}
        scene["loads"][0].update(start=0.0, interpolation=kind)
        del scene["run"]
        path = tmp_path / f"{kind}.json"
        path.write_text(json.dumps(scene))
        made.append(Library(pack(path, version)))
        return made[-1]

    yield make
    for library in made:
        library.close()


def tip(library, u, slope=None):
    """Displacement of the tip after each of eight steps, before which u(t), and the slope, is set."""
    pad = Instance(library).start(press=u(0.0))
    rows = []
    for k in range(8):
        assert pad.set("press", u(k * STEP)) == OK
        if slope is not None:
            assert pad.input_derivative("press", slope) == OK
        assert pad.step(k * STEP, STEP) == OK, pad.log
        rows.append(pad.get("tip.displacement")[0])
    pad.free()
    return rows


def test_a_derivative_counts_from_the_beginning_of_the_step(rubbing):
    """FMI 2.0.5, 4.2.1: u(t) = u + d (t - tc): a ramp is the same ramp for held and linear loads."""
    found = [tip(rubbing(kind), lambda t: -0.3 * t, -0.3) for kind in ("hold", "linear")]
    assert found[0] == pytest.approx(found[1], abs=1e-12)
    assert found[0][0] == pytest.approx(0.0030, abs=5e-5)


def test_a_jump_happens_at_its_communication_point(rubbing):
    """With derivative 0 the load is constant over the step, not a ramp from the old value; so it is without a derivative."""
    jump = lambda t: 0.0 if t < 0.5 else -0.3  # noqa: E731
    for kind in ("hold", "linear"):
        for slope in (0.0, None):
            rows = tip(rubbing(kind), jump, slope)
            assert rows[:4] == [0.0] * 4 and rows[4] == pytest.approx(0.06353, abs=5e-6), (kind, slope)


def test_derivatives_that_are_no_numbers_or_of_outputs_are_refused(rubbing):
    library = rubbing("linear")
    pad = Instance(library).start()
    assert pad.input_derivative("press", float("nan")) in (DISCARD, ERROR)
    assert pad.input_derivative("press", 1.0, order=2) == ERROR
    assert pad.input_derivative("contact.max_slip_rate", 1.0) == ERROR
    assert pad.step(0.0, STEP) == OK and pad.get("tip.displacement") == [0.0, 0.0]
    pad.free()


def load(i):
    return -0.3 - 0.1 * (i % 3)


@pytest.mark.parametrize("place", [1, 2, 3])
def test_states_carry_the_meaning_and_the_slopes(library, place):
    """Rolled back, and continued from bytes by a fresh instance, the run is the same bit for bit."""
    pad = Instance(library)
    assert pad.choice("time.inputs") == 3 and pad.choice("time.inputs", place) == OK
    pad.start(press=load(0))

    def go(pad, begin, end):
        for i in range(begin, end):
            assert pad.set("press", load(i)) == OK and pad.step(i * H, H) == OK, pad.log
        return pad.everything()

    go(pad, 0, 5)
    _, state = pad.save()
    data = pad.serialize(state)[1]
    ahead = go(pad, 5, 9)
    assert pad.restore(state) == OK and go(pad, 5, 9) == ahead
    other = Instance(library)
    status, copy = other.deserialize(data)
    assert status == OK and other.restore(copy) == OK and other.choice("time.inputs") == place
    assert go(other, 5, 9) == ahead
    assert pad.choice("time.inputs", place) == ERROR and "time.inputs is a fixed parameter" in pad.log[-1][3]
    other.free()
    pad.free()


def test_end_of_step_is_the_load_at_the_end(library):
    """A load that the master knows at the end of a step: a ramp is exact, where a held one lags by half a step."""

    def run(place, count, u):
        pad = Instance(library)
        assert pad.choice("time.inputs", place) == OK
        pad.start(press=0.0)
        h = 0.5 / count
        for i in range(count):
            assert pad.set("press", u(i * h, h)) == OK and pad.step(i * h, h) == OK
        found = pad.get("press.displacement")[0]
        pad.free()
        return found

    exact = run(1, 256, lambda t, h: -0.6 * (t + h))
    ends, held = run(1, 16, lambda t, h: -0.6 * (t + h)), run(2, 16, lambda t, h: -0.6 * t)
    assert abs(ends - exact) < 0.05 * abs(held - exact)


@pytest.mark.parametrize("place", [1, 2, 3])
def test_derivatives_are_those_of_differences_for_every_meaning(library, place):
    pad = Instance(library)
    assert pad.choice("time.inputs", place) == OK
    pad.start(press=-0.30)
    for i, value in enumerate((-0.30, -0.31, -0.325)):
        assert pad.set("press", value) == OK and pad.step(i * H, H) == OK
    _, state = pad.save()
    names = ["contact.slip_rate", "contact.slip", "contact.tangential_stress", "press.velocity", "press.displacement"]

    def at(value):
        assert pad.restore(state) == OK and pad.set("press", value) == OK and pad.step(3 * H, H) == OK
        return [pad.get(name) for name in names]

    d, press = 1e-7, library.reference("press")
    high, low = at(-0.34 + d), at(-0.34 - d)
    at(-0.34)
    for name, up, down in zip(names, high, low):
        expected = [(x - y) / (2 * d) for x, y in zip(up, down)]
        status, found = pad.directional(library.reference(name), press, [1.0], library.length(name))
        assert status == OK and max(map(abs, expected)) > 0
        assert found == pytest.approx(expected, abs=1e-4 * max(map(abs, expected))), name
    pad.free()
