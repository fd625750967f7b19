"""Coefficients of friction of every form: under their names, with their start values, set as numbers and as arrays, between steps."""

import json
import zlib

import pytest
from raw import ERROR, H, Instance, Library, OK

FIELD = [0.003 + 1e-4 * i for i in range(32)]
STRIBECK = {"kind": "stribeck", "static": {"nodes": FIELD}, "kinetic": 0.001, "velocity": 0.02, "exponent": 1.5, "viscous": 0.01}
TABLE = {"kind": "table", "rate": [0.0, 0.02, 0.5], "value": [0.003, 0.001, 0.002], "scale": 1.0}
VALUES = {"static": [0.004] * 32, "kinetic": [0.002], "velocity": [0.03], "exponent": [2.0], "viscous": [0.02],
          "rate": [0.0, 0.05, 0.2], "value": [0.004, 0.002, 0.003], "scale": [0.5]}


@pytest.fixture(params=["2", "3", "3 scalar"])
def load(request, pack, pack_scene):
    def make(bound):
        return Library(pack_scene(bound, request.param))

    return make


@pytest.fixture
def pack_scene(pack, tmp_path):
    from conftest import BUILD, run

    def make(bound, kind):
        scene = json.loads(run(BUILD / "stickslip", "example", "kazmi2014"))
        scene["contact"]["friction"] = {"law": "bound", "bound": bound}
        text = json.dumps(scene)
        path = tmp_path / f"{bound['kind']}_{zlib.crc32(text.encode())}.json"
        path.write_text(text)
        return pack(path, kind)

    return make


def numbers(value):
    return value["nodes"] if isinstance(value, dict) else value if isinstance(value, list) else [value]


def run_with(library, names, values, when):
    """The outputs of eight steps, with these coefficients set before the start, between steps, or never."""
    pad = Instance(library)
    change = lambda: [pad.set(f"contact.friction.bound.{n}", *values[n]) == OK for n in names]
    if when == "before":
        assert all(change())
    pad.start()
    for i in range(8):
        if i == 3 and when == "between":
            assert all(change())
        assert pad.step(i * H, H) == OK, pad.log
    end = pad.everything()
    pad.free()
    return end


@pytest.mark.parametrize("bound", [STRIBECK, TABLE], ids=lambda b: b["kind"])
def test_coefficients_are_parameters(load, bound):
    library = load(bound)
    names = [key for key in bound if key != "kind"]
    pad = Instance(library)
    pad.start()
    for name in names:
        assert pad.get(f"contact.friction.bound.{name}") == numbers(bound[name])
    pad.free()
    unchanged = run_with(library, names, VALUES, "never")
    changed = [run_with(library, order, VALUES, when) for when in ("before", "between") for order in (names, names[::-1])]
    # names come in any order, and what is set acts
    assert changed[0] == changed[1] != unchanged
    assert changed[2] == changed[3] != unchanged
    # the same as the scene with these numbers
    values = {name: VALUES[name] if isinstance(bound[name], list) else VALUES[name][0] for name in names}
    if bound is STRIBECK:
        values["static"] = {"nodes": VALUES["static"]}
    other = load({"kind": bound["kind"], **values})
    assert run_with(other, names, VALUES, "never") == changed[0]
    library.close()
    other.close()


def test_a_set_that_does_not_fit_is_refused_where_it_would_act(load):
    library = load(TABLE)
    pad = Instance(library).start()
    assert pad.step(0.0, H) == OK
    before = pad.everything()
    assert pad.set("contact.friction.bound.rate", 0.0, 0.6, 0.5) == OK
    assert pad.step(H, H) == ERROR and "contact.friction.bound.rate at point 2" in pad.log[-1][3]
    assert pad.set("contact.friction.bound.value", 0.003, -0.001, 0.002) != OK
    assert pad.set("contact.friction.bound.rate", 0.0, 0.4, 0.5) == OK
    assert pad.get("contact.friction.bound.value") == TABLE["value"]
    assert pad.step(H, H) == OK and pad.everything() != before
    pad.free()
    library.close()
