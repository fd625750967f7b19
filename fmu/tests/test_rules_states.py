"""Rules of saved states, rollback and derivatives: one test per rule, for both versions, each with the answer that the rule states."""

import os
import random
import subprocess
import sys
from ctypes import c_void_p

import pytest
from raw import ERROR, H, Instance, Library, OK, stepped


def test_22_step_rollback_step_is_equal_bit_for_bit(pad):
    stepped(pad)
    status, state = pad.save()
    assert status == OK
    assert pad.set("press", -0.2) == OK and pad.step(4 * H, H) == OK
    once = pad.everything()
    assert pad.set("press", 0.1) == OK and pad.step(5 * H, 3 * H) == OK
    assert pad.restore(state) == OK
    assert pad.set("press", -0.2) == OK and pad.step(4 * H, H) == OK
    assert pad.everything() == once


def test_23_saving_into_a_handle_keeps_it(pad):
    stepped(pad)
    _, state = pad.save()
    before = state.value
    assert pad.step(4 * H, H) == OK
    status, state = pad.save(state)
    assert status == OK and state.value == before
    now = pad.everything()
    assert pad.step(5 * H, H) == OK and pad.restore(state) == OK
    assert pad.everything() == now


def test_24_state_freed_twice_through_its_nulled_pointer_is_ok(pad):
    stepped(pad)
    _, state = pad.save()
    assert pad.drop(state) == OK and state.value is None
    assert pad.drop(state) == OK


def test_25_freed_or_foreign_state_is_an_error(library, pad):
    stepped(pad)
    _, state = pad.save()
    other = stepped(Instance(library))
    assert other.restore(state) == ERROR and other.drop(c_void_p(state.value)) == ERROR
    stale = c_void_p(state.value)
    assert pad.drop(state) == OK
    assert pad.restore(stale) == ERROR and pad.restore(None) == ERROR
    assert pad.drop(stale) == ERROR
    assert pad.serialize(stale)[0] == ERROR
    other.free()


def test_26_restoring_after_an_error_goes_on(pad):
    stepped(pad)
    _, state = pad.save()
    assert pad.step(4 * H, -1.0) == ERROR
    assert pad.restore(state) == OK and pad.step(4 * H, H) == OK


OTHER_PROCESS = """
import sys
from raw import OK, Instance, Library
fmu, data = sys.argv[1:]
pad = Instance(Library(fmu))
status, state = pad.deserialize(open(data, "rb").read())
assert status == OK, pad.log
assert pad.restore(state) == OK
for i in range(4, 8):
    assert pad.step(i / 32, 1 / 32) == OK, pad.log
print(" ".join(x.hex() for x in pad.everything()))
"""


@pytest.mark.parametrize("young", [1.0, 1.25])
def test_27_state_continues_in_another_process_bit_for_bit(paper, pad, tmp_path, young):
    stepped(pad, **{"material.elasticity.young": young})
    _, state = pad.save()
    status, data = pad.serialize(state)
    assert status == OK
    (tmp_path / "state").write_bytes(data)
    command = [sys.executable, "-c", OTHER_PROCESS, paper, tmp_path / "state"]
    done = subprocess.run(command, cwd=os.path.dirname(__file__), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for i in range(4, 8):
        assert pad.step(i * H, H) == OK
    assert [float.fromhex(x) for x in done.stdout.split()] == pad.everything()


def test_28_damaged_or_foreign_bytes_are_an_error(pack, version, pad):
    stepped(pad)
    before = pad.everything()
    data = pad.serialize(pad.save()[1])[1]
    assert pad.deserialize(data)[0] == OK
    places = random.Random(1).sample(range(len(data)), 40)
    for broken in [b"", data[:7], data[:-1], data[: len(data) // 2], data + b"\0"] + [
        data[:i] + bytes([data[i] ^ 1 << i % 8]) + data[i + 1 :] for i in places
    ]:
        assert pad.deserialize(broken)[0] == ERROR
    library = Library(pack("brake_pad_3d", version))
    other = Instance(library).start()
    assert pad.deserialize(other.serialize(other.save()[1])[1])[0] == ERROR
    assert pad.everything() == before
    other.free()
    library.close()


def test_29_buffer_that_is_too_small_is_an_error(pad):
    stepped(pad)
    _, state = pad.save()
    status, data = pad.serialize(state)
    assert status == OK
    assert pad.serialize(state, size=len(data) - 1)[0] == ERROR


@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d"])
def test_30_directional_derivative_is_that_of_differences_by_rollback(pack, version, scene):
    library = Library(pack(scene, version))
    pad = Instance(library)
    name = next(v.name for v in library.variables.values() if v.causality == "input")
    base, d = (-0.3, 1e-6) if scene == "kazmi2014" else (2e5, 1.0)
    h = library.description.defaultExperiment.stepSize
    h = float(h)
    pad.start(**{name: base})
    for i in range(3):
        assert pad.step(i * h, h) == OK
    _, state = pad.save()
    outputs = ["contact.slip_rate", "contact.slip", "contact.tangential_stress", "contact.force", f"{name}.displacement", f"{name}.velocity"]

    def at(value):
        assert pad.restore(state) == OK
        assert pad.set(name, value) == OK and pad.step(3 * h, h) == OK
        return [pad.get(o) for o in outputs]

    high, low = at(base + d), at(base - d)
    at(base)
    for output, up, down in zip(outputs, high, low):
        difference = [(x - y) / (2 * d) for x, y in zip(up, down)]
        u = library.reference(output)
        status, found = pad.directional(u, library.reference(name), [1.0], library.length(output))
        assert status == OK, pad.log
        scale = max(map(abs, difference))
        assert max(abs(x - y) for x, y in zip(found, difference)) <= 1e-5 * scale, output
        if version == "3":
            weights = [1.0 + i for i in range(len(found))]
            status, back = pad.adjoint(u, library.reference(name), weights)
            assert status == OK
            direct = sum(w * x for w, x in zip(weights, found))
            assert abs(back[0] - direct) <= 1e-12 * sum(abs(w * x) for w, x in zip(weights, found))
    pad.free()
    library.close()


def test_31_derivative_of_an_illegal_pair_is_an_error(library, pad):
    stepped(pad)
    press, rate = library.reference("press"), library.reference("contact.max_slip_rate")
    alpha = library.reference("contact.friction.alpha")
    assert pad.directional(rate, press, [1.0])[0] == OK
    assert pad.directional(press, press, [1.0])[0] == ERROR
    assert pad.directional(rate, alpha, [1.0])[0] == ERROR
    assert pad.directional(rate, rate, [1.0])[0] == ERROR
    assert pad.directional([999_999], press, [1.0])[0] == ERROR
    assert pad.output_derivative("press")[0] == ERROR
    assert pad.output_derivative("contact.slip", order=2)[0] == ERROR
    status, slope = pad.output_derivative("contact.slip")
    assert status == OK and slope == pad.get("contact.slip_rate")
