"""A material that stays free: its numbers are set in initialization mode, without compiling again, and travel with saved states."""

import json

import pytest
from raw import ERROR, H, Instance, Library, OK

NUMBERS = {"material.elasticity.poisson": 0.4999, "material.viscosity.mu2": 0.3, "material.memory[0].tau": 0.3,
           "material.memory[0].bulk": 0.0}


def scene(free, **numbers):
    material = {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
                "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"},
                "memory": [{"law": "isotropic", "tau": 0.05, "shear": 0.3, "bulk": 0.5}]}
    for path, value in numbers.items():
        *keys, last = path.replace("[0]", ".0").split(".")[1:]
        place = material
        for key in keys:
            place = place[int(key) if key == "0" else key]
        place[last] = value
    return {"schema_version": 1, "name": "pad", "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
            "material": material, "clamped": ["left"],
            "contact": {"part": "bottom", "friction": {"law": "tresca", "bound": 0.05}},
            "loads": [{"name": "pull", "kind": "traction", "part": "top", "direction": [1, 0], "start": 0.2}],
            "time": {"step": H}, "run": {"until": 8 * H},
            "fidelity": {"tolerance": 1e-9, "free_material": True} if free else {"model": "condensed"}}


@pytest.fixture
def library(tmp_path, pack, version):
    path = tmp_path / f"free_{version}.json"
    path.write_text(json.dumps(scene(True)))
    library = Library(pack(path, version))
    yield library
    library.close()


def steps(pad, count):
    for i in range(count):
        assert pad.step(i * H, H) == OK, pad.log
    return pad.get("contact.slip")


def test_numbers_are_set_in_initialization_mode(library, tmp_path, pack, version):
    pad = Instance(library)
    assert pad.setup() == OK and pad.enter() == OK
    for name, value in NUMBERS.items():
        assert pad.set(name, value) == OK, pad.log
    assert pad.exit() == OK, pad.log
    assert any("set without compiling" in str(line) and "mu2" in str(line) for line in pad.log), pad.log
    found = steps(pad, 8)
    assert pad.get("material.memory[0].tau") == [0.3]
    assert pad.set("material.elasticity.young", 2.0) == ERROR
    pad.free()

    path = tmp_path / f"compiled_{version}.json"
    path.write_text(json.dumps(scene(False, **NUMBERS)))
    other = Library(pack(path, version))
    reference = Instance(other).start()
    expected = steps(reference, 8)
    largest = max(map(abs, expected))
    assert largest > 1e-3
    assert max(abs(a - b) for a, b in zip(found, expected)) < 1e-7 * largest
    reference.free()
    other.close()


def test_wrong_numbers_are_refused_and_states_carry_theirs(library):
    pad = Instance(library)
    assert pad.setup() == OK and pad.set("material.elasticity.poisson", 0.5) == OK
    assert pad.enter() == ERROR and "material.elasticity.poisson" in str(pad.log[-1])
    assert pad.set("material.elasticity.poisson", 0.45) == OK and pad.enter() == OK and pad.exit() == OK, pad.log
    steps(pad, 4)
    _, state = pad.save()
    status, data = pad.serialize(state)
    assert status == OK

    other = Instance(library).start()
    status, state = other.deserialize(data)
    assert status == OK and other.restore(state) == OK, other.log
    assert other.get("material.elasticity.poisson") == [0.45]
    for i in range(4, 8):
        assert pad.step(i * H, H) == OK and other.step(i * H, H) == OK
    assert pad.everything() == other.everything()
    pad.free()
    other.free()
