"""Notes on accepted steps reach the log when they begin and when they have ended; steps that cannot be right are refused."""

import json

import pytest
from raw import ERROR, H, Instance, Library, OK, WARNING
from trajectories import ROOT

PAPER = json.loads((ROOT / "src/scene/examples/kazmi2014.json").read_text())


@pytest.fixture
def pad_of(pack, version, tmp_path):
    opened = []

    def make(name, changes, **arguments):
        path = tmp_path / f"{name}.json"
        path.write_text(json.dumps(PAPER | changes))
        library = Library(pack(path, version))
        pad = Instance(library, **arguments)
        opened.append((library, pad))
        return pad

    yield make
    for library, pad in opened:
        pad.free()
        library.close()


def twofold():
    """Steps with two solutions while it slips, with one before and at rest."""
    friction = {"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 400.0}
    return {
        "contact": {"part": "bottom", "friction": friction},
        "time": {"scheme": "trapezoid", "start": "zero", "step": H, "inputs": "end_of_step"},
        "fidelity": PAPER["fidelity"] | {"multiplicity_test": True},
    }


def graded():
    """Flat cells at the corners, at which forces cancel to rounding."""
    return {
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [64, 4], "grading": [3, 1]},
        "fidelity": PAPER["fidelity"] | {"model": "auto"},
    }


CASES = {
    "twofold": (twofold, lambda pad: pad.get("solver.solutions")[0] > 1, "solutions"),
    "graded": (graded, lambda pad: pad.get("solver.residual")[0] > 1e-10, "as well as rounding allows"),
}


def run(pad, applies):
    """Whether the note applies to each step, and the messages of each step; the load goes at the end."""
    noted, told = [], []
    for i in range(32):
        count = len(pad.log)
        if i == 26:
            assert pad.set("press", 0.0) == OK
        assert pad.step(i * H, H) == OK
        noted.append(applies(pad))
        told.append(pad.log[count:])
    return noted, told


@pytest.mark.parametrize("name", CASES)
def test_note_is_a_warning_when_it_begins_and_a_message_when_it_has_ended(pad_of, name):
    changes, applies, word = CASES[name]
    pad = pad_of(name, changes()).start()
    noted, told = run(pad, applies)
    assert any(noted) and not all(noted)
    begun, ended = 0, 0
    for before, now, messages in zip([False, *noted], noted, told):
        assert len(messages) == (before != now)
        for status, category, _, text in messages:
            assert category == "logStatusWarning" and status == (WARNING if now else OK)
            assert not now or word in text
            begun, ended = begun + now, ended + (not now)
    assert begun >= 1 and ended >= 1


@pytest.mark.parametrize("name", CASES)
def test_note_is_silent_where_its_category_is_off_and_told_when_it_is_switched_on(pad_of, name):
    changes, applies, word = CASES[name]
    pad = pad_of(name, changes(), logging=False).start()
    noted, told = run(pad, applies)
    assert any(noted) and not any(told)
    assert pad.reset() == OK and pad.debug(True, [b"logEvents"]) == OK
    pad.start()
    assert not any(run(pad, applies)[1])
    # switched on between two steps that both have it
    first = next(i for i in range(31) if noted[i] and noted[i + 1])
    assert pad.reset() == OK
    pad.start()
    for i in range(32):
        if i == first + 1:
            assert pad.log == [] and pad.debug(True, [b"logStatusWarning"]) == OK
        assert pad.step(i * H, H) == OK
        if i == first + 1:
            assert [m[:2] for m in pad.log] == [(WARNING, "logStatusWarning")] and word in pad.log[0][3]


def test_note_is_told_anew_after_a_reset(pad_of):
    changes, applies, _ = CASES["twofold"]
    pad = pad_of("twofold", changes()).start()
    first = run(pad, applies)
    assert pad.reset() == OK
    pad.start()
    assert run(pad, applies) == first


def test_explicit_scheme_beyond_its_stability_limit_is_refused_at_initialization(paper):
    library = Library(paper)
    pad = Instance(library)
    assert pad.choice("time.scheme", 2) == OK and pad.set("time.step", 1.0) == OK
    # the limit of the scene: 2 over 14.56 1/s, the fastest rate of its material
    assert pad.setup() == OK and pad.enter() == ERROR
    status, category, _, text = pad.log[-1]
    assert (status, category) == (ERROR, "logStatusError") and "stability limit" in text and "0.137" in text
    assert pad.step(0.0, H) == ERROR  # still before the initialization
    # a material a hundred times as fast, at the scene's own step
    assert pad.set("time.step", H) == OK
    assert pad.set("material.viscosity.mu1", 5e-4) == OK and pad.set("material.viscosity.mu2", 1e-3) == OK
    assert pad.enter() == ERROR and "stability limit" in pad.log[-1][3]
    # and one that the scheme can follow
    assert pad.set("material.viscosity.mu1", 0.05) == OK and pad.set("material.viscosity.mu2", 0.1) == OK
    assert pad.enter() == OK and pad.exit() == OK
    for i in range(8):
        assert pad.step(i * H, H) == OK
    assert 0 < abs(pad.get("contact.max_slip_rate")[0]) < 1
    pad.free()
    library.close()
