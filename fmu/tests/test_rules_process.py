"""Rules of threads, the library in its process, logging and what is declared: one test per rule, for both versions, each with the answer that the rule states."""

import ctypes
import os
import signal
import subprocess
import sys
import threading
from ctypes import c_int, c_uint32, c_uint8

import pytest
from raw import ERROR, H, Instance, Library, OK, refused, stepped


def run_32(pad, out):
    stepped(pad, count=16)
    out.append(pad.everything())


def test_32_64_instances_in_threads_are_identical(library):
    pads, results = [Instance(library, name=b"pad%d" % i) for i in range(64)], []
    threads = [threading.Thread(target=run_32, args=(pad, results)) for pad in pads]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 64 and all(r == results[0] for r in results)
    for pad in pads:
        pad.free()


def test_33_instance_may_move_between_threads(library, pad):
    reference = stepped(Instance(library), count=8)
    pad.start()
    for i in range(8):
        thread = threading.Thread(target=lambda i=i: pad.step(i * H, H))
        thread.start()
        thread.join()
    assert pad.everything() == reference.everything()
    reference.free()


CYCLES = """
import gc, os, sys
from raw import OK, Instance, Library
def resident():
    return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
import _ctypes, ctypes
library = Library(sys.argv[1])
threads = len(os.listdir("/proc/self/task"))  # numpy brings its own
count = int(sys.argv[2])
sizes = []
for cycle in range(count):
    pad = Instance(library, logging=False).start()
    assert pad.step(0.0, 1 / 32) == OK
    pad.free()
    _ctypes.dlclose(library.dll._handle)
    del pad
    library.dll = ctypes.CDLL(library.path)
    for name in ("fmi2Instantiate", "fmi3InstantiateCoSimulation"):
        getattr(library.dll, name).restype = ctypes.c_void_p
    if cycle % 100 == 0:
        gc.collect()
        sizes.append(resident())
left = len(os.listdir("/proc/self/task")); assert left == threads, (left, threads)
_ctypes.dlclose(library.dll._handle)
print(*sizes)
"""


def test_34_load_and_free_cycles_do_not_grow(paper):
    command = [sys.executable, "-c", CYCLES, paper, "1200"]
    done = subprocess.run(command, cwd=os.path.dirname(__file__), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    sizes = [int(x) for x in done.stdout.split()]
    # callbacks of ctypes cost some memory per cycle; a leaked model would be 40 kB
    assert (sizes[-1] - sizes[2]) / 900 < 2000, sizes


@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d", "seal", "sheared_column"])
def test_34_library_is_unmapped_after_the_last_close(pack, version, scene):
    """A thread-local value with a destructor would keep it mapped, and its scratch allocated, until the thread ends."""
    library = Library(pack(scene, version))
    is_mapped = lambda: library.path in open("/proc/self/maps").read()  # noqa: E731
    pads = [stepped(Instance(library), count=4) for _ in range(2)]
    load = next(v.name for v in library.variables.values() if v.causality == "input")
    slip, length = library.reference("contact.slip"), library.length("contact.slip")
    for pad in pads:
        assert pad.step(4 * H, H / 2) == OK
        assert pad.directional(slip, library.reference(load), [1.0], length)[0] == OK
        assert pad.serialize(pad.save()[1])[0] == OK
        pad.free()
    assert is_mapped()
    library.close()
    assert not is_mapped()


def test_35_unloading_right_after_a_step_does_not_crash(paper):
    library = Library(paper)
    pad = stepped(Instance(library))
    assert pad.step(4 * H, H) == OK
    library.close()  # not freed, on purpose


def test_36_panic_is_an_error_and_the_host_lives(paper):
    injected = os.environ.get("STICKSLIP_PANIC_LIBRARY")
    if not injected:
        pytest.skip("STICKSLIP_PANIC_LIBRARY names no build with the feature panic-injection")
    library = Library(paper, library=injected)
    pad, other = stepped(Instance(library)), stepped(Instance(library))
    assert pad.set_refs([0xDEAD], [0.0]) == ERROR
    assert "panicked" in pad.log[-1][3]
    assert pad.step(4 * H, H) == ERROR and pad.reset() == ERROR
    assert other.step(4 * H, H) == OK
    pad.free()
    other.free()
    library.close()


def test_37_errors_are_logged_whatever_is_on_and_unknown_categories_are_errors(library, pad):
    quiet = Instance(library, logging=False)
    assert quiet.set("material.elasticity.young", 1.25) == OK and quiet.setup() == OK and quiet.enter() == OK
    assert quiet.log == []  # an event: compiled anew
    assert quiet.step(0.0, H) == ERROR and len(quiet.log) == 1 and quiet.log[0][:2] == (ERROR, "logStatusError")
    assert pad.debug(True, [b"noSuchCategory"]) == ERROR
    assert "noSuchCategory" in pad.log[-1][3]
    count = len(pad.log)
    assert pad.debug(False, []) == OK
    assert pad.step(0.0, H) == ERROR and len(pad.log) == count + 1
    quiet.free()


def test_free_from_the_logger_leaves_the_instance_alone(library):
    pad = Instance(library)
    free = library.dll.fmi2FreeInstance if library.version == 2 else library.dll.fmi3FreeInstance
    answers = []

    class Greedy(list):
        def append(self, entry):
            super().append(entry)
            free(pad.p)  # in the middle of the call that logs
            answers.append(pad.reset())

    pad.log = Greedy()
    assert pad.step(0.0, H) == ERROR and answers == [ERROR]
    pad.log = []
    assert pad.start().step(0.0, H) == OK and pad.log == []
    pad.free()


def test_38_percent_signs_in_messages_are_printed_literally(library, pad):
    assert pad.debug(True, [b"%s%n%d"]) == ERROR
    status, category, form, message = pad.log[-1]
    assert form == "%s" and "%s%n%d" in message and status == ERROR and category == "logStatusError"


def test_39_event_mode_is_used_only_by_who_asks_for_it(library):
    assert refused(library, kind=0)  # Model Exchange
    if library.version == 3:
        plain = Instance(library).start()
        for name in ("fmi3EnterEventMode", "fmi3EnterStepMode"):
            assert getattr(library.dll, name)(plain.p) == ERROR and name in plain.log[-1][3]
        plain.free()
        asking = Instance(library, event_mode=True).start()
        # initialization leads to event mode
        assert asking.step(0.0, H) == ERROR and "in event mode" in asking.log[-1][3]
        assert library.dll.fmi3EnterStepMode(asking.p) == OK
        assert asking.step(0.0, H) == OK
        asking.free()


def test_40_no_early_return_without_event_mode(library):
    for early in (False, True):
        pad = Instance(library, early_return=early).start()
        assert pad.step(0.0, H) == OK
        if library.version == 3:
            assert pad.flags == [0, 0, 0, H]
        pad.free()


def test_41_process_settings_stay(library):
    libc = ctypes.CDLL(None)
    libc.setlocale.restype = ctypes.c_char_p
    controls = (c_uint8 * 64)()  # fenv_t of x86-64 has 32 bytes

    def settings():
        libc.fegetenv = ctypes.CDLL("libm.so.6").fegetenv
        libc.fegetenv(controls)
        words = ctypes.cast(controls, ctypes.POINTER(c_uint32))
        # x87 control word and mxcsr without its sticky exception flags
        fp = (words[0] & 0xFFFF, words[7] & ~0x3F)
        handlers = [signal.getsignal(s) for s in (signal.SIGFPE, signal.SIGSEGV, signal.SIGINT, signal.SIGABRT)]
        caught = [line for line in open("/proc/self/status") if line.startswith("Sig") and "Q" not in line]
        return fp, libc.setlocale(6, None), os.getcwd(), handlers, caught

    before = settings()
    pad = stepped(Instance(library))
    assert settings() == before
    pad.free()
    assert settings() == before


def test_42_reset_and_rerun_is_equal_bit_for_bit(pad):
    once = stepped(pad, **{"press": -0.25, "contact.friction.alpha": 40.0}).everything()
    assert pad.reset() == OK
    fresh = stepped(pad).everything()
    assert pad.reset() == OK
    again = stepped(pad, **{"press": -0.25, "contact.friction.alpha": 40.0}).everything()
    assert once == again and fresh != once


def test_43_undeclared_capabilities_are_errors_with_a_message(library, pad):
    pad.start()
    if library.version == 2:
        names = ["fmi2CancelStep", "fmi2GetIntegerStatus", "fmi2GetStringStatus"]
        arguments = [(), (0, c_int(0)), (0, None)]
    else:
        names = (
            "GetBinary SetBinary GetClock SetClock GetNumberOfVariableDependencies GetVariableDependencies "
            "EnterConfigurationMode ExitConfigurationMode EnterEventMode EnterStepMode GetIntervalDecimal "
            "GetIntervalFraction GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction SetShiftDecimal "
            "SetShiftFraction EvaluateDiscreteStates UpdateDiscreteStates EnterContinuousTimeMode CompletedIntegratorStep "
            "SetTime SetContinuousStates GetContinuousStateDerivatives GetEventIndicators GetContinuousStates "
            "GetNominalsOfContinuousStates GetNumberOfEventIndicators GetNumberOfContinuousStates ActivateModelPartition"
        ).split()
        names = ["fmi3" + n for n in names]
        arguments = [(None,) * 6] * len(names)
    for name, rest in zip(names, arguments):
        count = len(pad.log)
        assert getattr(library.dll, name)(pad.p, *rest) == ERROR, name
        assert len(pad.log) == count + 1 and name in pad.log[-1][3]


def test_44_start_values_of_the_description_are_those_of_a_fresh_instance(library, pad):
    count = 0
    for variable in library.variables.values():
        if variable.start is None:
            continue
        count += 1
        if variable.type in ("Real", "Float64"):
            assert pad.get(variable.name) == [float(variable.start)], variable.name
        else:
            assert pad.choice(variable.name) == int(variable.start), variable.name
    assert count >= 15
