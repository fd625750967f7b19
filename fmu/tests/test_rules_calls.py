"""Rules of calls in each phase, of references and values, and of steps: one test per rule, for both versions, each with the answer that the rule states."""

import math
from ctypes import c_double, c_size_t, c_uint32

import pytest
from raw import DISCARD, ERROR, H, Instance, Library, OK, stepped


def test_07_step_before_initialization_ends_is_an_error(pad):
    assert pad.step(0.0, H) == ERROR
    assert pad.setup() == OK and pad.enter() == OK
    assert pad.step(0.0, H) == ERROR
    assert pad.exit() == OK and pad.step(0.0, H) == OK


def test_08_initialization_entered_twice_is_an_error(pad):
    assert pad.exit() == ERROR
    assert pad.setup() == OK and pad.enter() == OK
    assert pad.enter() == ERROR
    assert pad.exit() == OK and pad.exit() == ERROR


def test_09_setup_after_initialization_is_an_error(library, pad):
    pad.start()
    assert (pad.setup() if library.version == 2 else pad.enter()) == ERROR


def test_10_step_after_termination_is_an_error_until_reset(pad):
    stepped(pad)
    assert pad.terminate() == OK
    assert pad.step(4 * H, H) == ERROR and pad.terminate() == ERROR
    assert pad.reset() == OK
    stepped(pad)


def test_11_values_after_termination_are_the_last(pad):
    before = stepped(pad).everything()
    assert pad.terminate() == OK
    assert pad.everything() == before


def test_12_unknown_reference_is_an_error(pad):
    one = (c_double * 1)()
    for reference in (999_999, 1 << 24 | 9999, 2**32 - 1):
        assert pad.get_refs([reference], one) == ERROR
        assert pad.set_refs([reference], [0.0]) == ERROR


def test_13_setting_an_output_or_a_fixed_parameter_in_step_mode_is_an_error(library, pad):
    stepped(pad)
    before = pad.everything()
    slip = library.reference("contact.max_slip_rate")
    assert pad.set_refs(slip, [1.0]) == ERROR
    assert pad.set("time.step", 0.01) == ERROR
    assert pad.choice("time.scheme", 2) == ERROR
    assert pad.everything() == before
    assert pad.set("contact.friction.alpha", 50.0) == OK


def test_14_getter_of_the_wrong_type_is_an_error(library, pad):
    assert pad.get_refs(library.reference("time.scheme"), (c_double * 1)()) == ERROR
    refs, count = (c_uint32 * 1)(*library.reference("contact.max_slip_rate")), c_size_t(1)
    space = (c_double * 1)()
    if library.version == 2:
        for name in ("Integer", "Boolean", "String"):
            assert getattr(library.dll, "fmi2Get" + name)(pad.p, refs, count, space) == ERROR
    else:
        for name in "Float32 Int8 UInt8 Int16 UInt16 Int32 UInt32 Int64 UInt64 Boolean String".split():
            assert getattr(library.dll, "fmi3Get" + name)(pad.p, refs, count, space, count) == ERROR


def test_15_wrong_number_of_values_is_an_error(library, pad):
    if library.version == 2:
        pytest.skip("FMI 2 states one number for references and values")
    slip = library.reference("contact.slip_rate")
    n = library.length("contact.slip_rate")
    assert pad.get_refs(slip, (c_double * n)()) == OK
    assert pad.get_refs(slip, (c_double * (n - 1))()) == ERROR
    assert pad.get_refs(slip, (c_double * (n + 1))()) == ERROR
    assert pad.set_refs(library.reference("press"), [0.0, 0.0]) == ERROR


def test_16_null_array_is_an_error_unless_empty(library, pad):
    one = (c_double * 1)()
    assert pad.get_refs([1], one, references_null=True) == ERROR
    assert pad.get_refs([1], one, values_null=True) == ERROR
    assert pad.set_refs([1], [0.0], null=True) == ERROR
    empty = (c_double * 0)()
    assert pad.get_refs([], empty, references_null=True, values_null=True) == OK
    assert pad.set_refs([], [], null=True) == OK


def test_17_input_that_is_not_finite_changes_nothing(library, pad):
    stepped(pad)
    before = pad.everything(), pad.get("press")
    for value in (math.nan, math.inf, -math.inf):
        assert pad.set("press", value) == (ERROR if library.version == 2 else DISCARD)
    assert (pad.everything(), pad.get("press")) == before
    assert pad.step(4 * H, H) == OK


def test_18_step_that_is_not_positive_is_an_error(pad):
    stepped(pad)
    before = pad.everything()
    for h in (0.0, -H, math.nan, math.inf):
        assert pad.step(4 * H, h) == ERROR
    assert pad.everything() == before
    assert pad.step(4 * H, H) == OK


def test_19_time_off_by_rounding_is_accepted(pad):
    pad.start()
    t = 0.0
    for i in range(50):
        assert pad.step(t, 0.1) == OK
        t = math.nextafter(0.1 * (i + 1), (-1) ** i * math.inf)


def test_20_time_off_by_more_than_the_step_is_an_error(pad):
    stepped(pad)
    before = pad.everything()
    for t in (0.0, 4 * H + 10 * H, math.nan):
        assert pad.step(t, H) == ERROR
    assert pad.everything() == before


def test_21_step_that_does_not_converge_changes_nothing(pack, version):
    """An input so large that the residual cannot reach its tolerance; with the old input the step works."""
    library = Library(pack("kazmi2014", version))
    pad = stepped(Instance(library))
    before, (_, state) = pad.everything(), pad.save()
    assert pad.set("press", 1e300) == OK
    status = pad.step(4 * H, H)
    assert status == (ERROR if version == "2" else DISCARD), (status, pad.log)
    assert pad.everything() == before
    assert pad.restore(state) == OK
    assert pad.step(4 * H, H / 2) == OK
    pad.free()
    library.close()
