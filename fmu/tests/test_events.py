"""Events of FMI 3: the contact begins or ceases to slip, to stick, to be open, to be closed. They are located in time, one per change, and
only for importers that ask for event mode."""

from ctypes import byref, c_double, c_uint8

import fmpy
import numpy as np
import pytest
from fmpy.simulation import simulate_fmu
from raw import ERROR, OK, Instance, Library

STEP = 1 / 16
END = 1.0


@pytest.fixture(scope="module")
def packed(pack):
    return pack("kazmi2014", "3")


@pytest.fixture
def library(packed):
    library = Library(packed)
    yield library
    library.close()


def press(t):
    """Rises from nothing and goes: the contact sticks, slips in part, slips whole; as the motion turns, node after node sticks and slips."""
    return -0.3 * np.sin(np.pi * t) ** 2


def update(pad):
    flags, next_event = [c_uint8(9) for _ in range(5)], c_double(-1)
    status = pad.dll.fmi3UpdateDiscreteStates(pad.p, *map(byref, flags), byref(next_event))
    return status, [f.value for f in flags]


def share(pad):
    """Whether no node, some nodes or all nodes stick."""
    (fraction,) = pad.get("contact.stick_fraction")
    return 0 if fraction == 0 else 2 if fraction == 1 else 1


def course(library, early=True):
    """Steps with event mode; the communication points, and the times of events with the shares before and after."""
    pad = Instance(library, event_mode=True, early_return=early)
    pad.start(press=0.0)
    assert pad.dll.fmi3EnterStepMode(pad.p) == OK
    t, points, events = 0.0, [], []
    while t < END:
        pad.set("press", press(t))
        before, h = share(pad), min(STEP * (1 + np.floor(t / STEP + 1e-9)), END) - t
        assert pad.step(t, h) == OK, pad.log
        event, terminate, is_early, last = pad.flags
        assert not terminate and (is_early == (last < t + h)) and pad.get("time") == [last]
        assert bool(event) == (share(pad) != before)
        if event:
            events.append((last, before, share(pad)))
            assert pad.dll.fmi3EnterEventMode(pad.p) == OK
            assert update(pad) == (OK, [0] * 5)
            assert pad.step(last, STEP) == ERROR
            assert pad.dll.fmi3EnterStepMode(pad.p) == OK
        points.append(last)
        t = last
    told = [m for _, category, _, m in pad.log if category == "logEvents"]
    assert len(told) == len(events) and all("contact: " in m and "stick" in m for m in told), told
    pad.free()
    return points, events


def test_events_are_declared(packed):
    capabilities = fmpy.read_model_description(str(packed)).coSimulation
    assert capabilities.hasEventMode and capabilities.mightReturnEarlyFromDoStep


def test_one_event_per_change(library):
    points, events = course(library)
    changes = [(before, after) for _, before, after in events]
    assert changes[0] == (2, 1) and (1, 0) in changes and (0, 1) in changes, changes
    assert all(a != b for a, b in changes)
    # the share at the end of one event is the one before the next: nothing was missed, nothing is told twice
    assert all(x[1] == y[0] for x, y in zip(changes, changes[1:])), changes
    assert len(points) <= round(END / STEP) + 2 * len(events)


def test_an_event_is_where_bisection_by_rollback_finds_it(library):
    points, events = course(library)
    pad = Instance(library).start(press=0.0)
    found, t = [], 0.0
    for point in points:
        pad.set("press", press(t))
        before = share(pad)
        status, saved = pad.save()
        assert status == OK
        assert pad.step(t, point - t) == OK
        if share(pad) != before:
            low, high = 0.0, STEP * (1 + np.floor(t / STEP + 1e-9)) - t
            while high - low > 1e-11:
                middle = (low + high) / 2
                assert pad.restore(saved) == OK and pad.step(t, middle) == OK
                low, high = (middle, high) if share(pad) == before else (low, middle)
            found.append(t + high)
            assert pad.restore(saved) == OK and pad.step(t, point - t) == OK
        pad.drop(saved)
        t = point
    pad.free()
    assert len(found) == len(events) >= 3
    assert np.allclose(found, [time for time, _, _ in events], rtol=0, atol=1e-9)


def test_without_early_return_a_step_is_whole_and_the_event_is_told_at_its_end(library):
    points, events = course(library, early=False)
    assert np.allclose(points, STEP * np.arange(1, len(points) + 1), rtol=0, atol=1e-12)
    assert len(events) >= 3


def test_event_mode_changes_no_bit_where_nothing_happens(library):
    plain = Instance(library).start(press=0.0)
    asking = Instance(library, event_mode=True, early_return=True).start(press=0.0)
    assert asking.dll.fmi3EnterStepMode(asking.p) == OK
    for i in range(8):
        for pad in (plain, asking):
            pad.set("press", -1e-4 * i)
            assert pad.step(i * STEP, STEP) == OK
        assert asking.flags[:3] == [0, 0, 0]
    assert plain.everything() == asking.everything() and max(map(abs, plain.everything())) > 0
    plain.free()
    asking.free()


def test_states_remember_event_mode(library):
    pad = Instance(library, event_mode=True).start(press=0.0)
    status, saved = pad.save()
    assert status == OK and pad.dll.fmi3EnterStepMode(pad.p) == OK
    assert pad.step(0.0, STEP) == OK
    assert pad.restore(saved) == OK and pad.step(0.0, STEP) == ERROR
    assert pad.dll.fmi3EnterStepMode(pad.p) == OK and pad.step(0.0, STEP) == OK
    pad.drop(saved)
    pad.free()


def test_fmpy_returns_early_and_goes_on(packed):
    times = np.linspace(0, END, 201)
    signals = np.array([(t, press(t)) for t in times], dtype=[("time", float), ("press", float)])
    run = {"stop_time": END, "step_size": STEP, "output_interval": STEP, "input": signals, "output": ["contact.stick_fraction"]}
    with_events = simulate_fmu(str(packed), use_event_mode=True, early_return_allowed=True, record_events=True, **run)
    sticks = with_events["contact.stick_fraction"]
    kinds = np.where(sticks == 0, 0, np.where(sticks == 1, 2, 1))
    assert len(with_events) > round(END / STEP) + 1, "events add communication points"
    assert {0, 1, 2} == set(kinds) and with_events["time"][-1] == pytest.approx(END)
