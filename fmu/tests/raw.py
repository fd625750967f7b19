"""Both versions of FMI through ctypes alone, so that every status and every pointer is seen as the library gives it.

A `Library` is an unpacked FMU, an `Instance` one instance of it. Methods have the same names and meaning for FMI 2 and
FMI 3 and return the status; nothing raises.
"""

import ctypes
import os
import shutil
import tempfile
import zipfile
from ctypes import byref, c_char, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint32, c_uint8, c_void_p

import _ctypes
from fmpy import read_model_description

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
LOG2 = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_char_p)
LOG3 = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)


class Callbacks2(ctypes.Structure):
    _fields_ = [
        ("logger", LOG2),
        ("allocate", c_void_p),
        ("free", c_void_p),
        ("finished", c_void_p),
        ("environment", c_void_p),
    ]


class Library:
    def __init__(self, fmu, library=None):
        self.folder = tempfile.mkdtemp(prefix="stickslip fmu ")  # a blank in the path, on purpose
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(self.folder)
        self.description = read_model_description(str(fmu), validate=False)
        self.version = 2 if self.description.fmiVersion.startswith("2") else 3
        platform = "linux64" if self.version == 2 else "x86_64-linux"
        self.path = os.path.join(self.folder, "binaries", platform, "stickslip_fmu.so")
        if library:
            shutil.copy(library, self.path)
        self.dll = ctypes.CDLL(self.path)
        d = self.description
        self.token = (d.guid if self.version == 2 else d.instantiationToken).encode()
        self.variables = {v.name: v for v in d.modelVariables}
        for name in ("fmi2Instantiate", "fmi3InstantiateCoSimulation", "fmi3InstantiateModelExchange"):
            getattr(self.dll, name).restype = c_void_p

    @property
    def resources(self):
        path = os.path.join(self.folder, "resources")
        return ("file://" + path.replace(" ", "%20") if self.version == 2 else path + "/").encode()

    def reference(self, name):
        """Value references of all elements of a variable, by its name without index."""
        if name in self.variables:
            return [self.variables[name].valueReference]
        found = [v.valueReference for v in self.variables.values() if v.name.startswith(name + "[")]
        assert found, name
        return found

    def length(self, name):
        v = self.variables.get(name)
        if v is None:
            return len(self.reference(name))
        return v.shape[0] * (v.shape[1] if len(v.shape) > 1 else 1) if v.dimensions else 1

    def close(self):
        _ctypes.dlclose(self.dll._handle)
        shutil.rmtree(self.folder)


class Instance:
    def __init__(self, library, name=b"pad", token=None, resources="own", logging=True, callbacks=True, kind=1, event_mode=False, early_return=False):
        self.library, self.dll, self.v = library, library.dll, library.version
        self.log = []
        self.experiment = 0.0, None, None
        token = library.token if token is None else (None if token is NULL else token)
        resources = library.resources if resources == "own" else resources
        if self.v == 2:
            self.sink = LOG2(lambda e, n, s, c, f, m: self.log.append((s, c.decode(), f.decode(), m.decode())))
            self.callbacks = Callbacks2(self.sink, None, None, None, None)
            pointer = byref(self.callbacks) if callbacks else None
            self.c = self.dll.fmi2Instantiate(name, kind, token, resources, pointer, 0, int(logging))
        else:
            self.sink = LOG3(lambda e, s, c, m: self.log.append((s, c.decode(), "%s", m.decode())))
            args = (name, token, resources, c_uint8(0), c_uint8(logging))
            if kind != 1:
                self.c = self.dll.fmi3InstantiateModelExchange(*args, None, self.sink)
            else:
                self.c = self.dll.fmi3InstantiateCoSimulation(
                    *args, c_uint8(event_mode), c_uint8(early_return), None, c_size_t(0), None, self.sink, None
                )
        self.flags = None

    @property
    def p(self):
        return c_void_p(self.c)

    def _f(self, two, three):
        return getattr(self.dll, two if self.v == 2 else three)

    # lifecycle
    def setup(self, start=0.0, stop=None, tolerance=None):
        """The experiment, which FMI 3 states when it enters initialization mode: `enter` then takes it from here."""
        self.experiment = start, stop, tolerance
        if self.v == 3:
            return OK
        of = lambda value: (int(value is not None), c_double(value or 0.0))  # noqa: E731
        return self.dll.fmi2SetupExperiment(self.p, *of(tolerance), c_double(start), *of(stop))

    def enter(self):
        if self.v == 2:
            return self.dll.fmi2EnterInitializationMode(self.p)
        start, stop, tolerance = self.experiment
        of = lambda value: (c_uint8(value is not None), c_double(value or 0.0))  # noqa: E731
        return self.dll.fmi3EnterInitializationMode(self.p, *of(tolerance), c_double(start), *of(stop))

    def exit(self):
        return self._f("fmi2ExitInitializationMode", "fmi3ExitInitializationMode")(self.p)

    def start(self, **values):
        assert self.setup() == OK and self.enter() == OK
        for name, value in values.items():
            assert self.set(name, value) == OK
        assert self.exit() == OK
        return self

    def step(self, t, h):
        if self.v == 2:
            return self.dll.fmi2DoStep(self.p, c_double(t), c_double(h), 1)
        flags = [c_uint8(9), c_uint8(9), c_uint8(9)]
        last = c_double(-1)
        status = self.dll.fmi3DoStep(self.p, c_double(t), c_double(h), c_uint8(1), *map(byref, flags), byref(last))
        self.flags = [f.value for f in flags] + [last.value]
        return status

    def terminate(self):
        return self._f("fmi2Terminate", "fmi3Terminate")(self.p)

    def reset(self):
        return self._f("fmi2Reset", "fmi3Reset")(self.p)

    def free(self):
        self._f("fmi2FreeInstance", "fmi3FreeInstance")(self.p)
        self.c = None

    def debug(self, on, categories):
        names = (c_char_p * len(categories))(*categories)
        flag = int(on) if self.v == 2 else c_uint8(on)
        return self._f("fmi2SetDebugLogging", "fmi3SetDebugLogging")(self.p, flag, c_size_t(len(categories)), names)

    # values
    def get_refs(self, references, values, count=None, references_null=False, values_null=False):
        n = len(references) if count is None else count
        refs = None if references_null else (c_uint32 * len(references))(*references)
        vals = None if values_null else values
        if self.v == 2:
            return self.dll.fmi2GetReal(self.p, refs, c_size_t(n), vals)
        return self.dll.fmi3GetFloat64(self.p, refs, c_size_t(n), vals, c_size_t(len(values)))

    def set_refs(self, references, values, null=False):
        refs = (c_uint32 * len(references))(*references)
        vals = None if null else (c_double * len(values))(*values)
        if self.v == 2:
            return self.dll.fmi2SetReal(self.p, refs, c_size_t(len(references)), vals)
        return self.dll.fmi3SetFloat64(self.p, refs, c_size_t(len(references)), vals, c_size_t(len(values)))

    def get(self, name):
        values = (c_double * self.library.length(name))()
        assert self.get_refs(self.library.reference(name), values) == OK, self.log
        return list(values)

    def set(self, name, *values):
        return self.set_refs(self.library.reference(name), values)

    def choice(self, name, value=None):
        refs = (c_uint32 * 1)(*self.library.reference(name))
        cell = ((c_int if self.v == 2 else c_int64) * 1)(0 if value is None else value)
        verb = "Get" if value is None else "Set"
        f = self._f(f"fmi2{verb}Integer", f"fmi3{verb}Int64")
        status = f(self.p, refs, c_size_t(1), cell, *(() if self.v == 2 else (c_size_t(1),)))
        assert value is not None or status == OK
        return cell[0] if value is None else status

    def everything(self):
        """Values of all outputs, in one list."""
        names = dict.fromkeys(n.split("[")[0] for n, v in self.library.variables.items() if v.causality == "output")
        return [x for n in names for x in self.get(n)]

    # states
    def save(self, state=None):
        state = c_void_p() if state is None else state
        return self._f("fmi2GetFMUstate", "fmi3GetFMUState")(self.p, byref(state)), state

    def restore(self, state):
        return self._f("fmi2SetFMUstate", "fmi3SetFMUState")(self.p, state)

    def drop(self, state):
        return self._f("fmi2FreeFMUstate", "fmi3FreeFMUState")(self.p, byref(state))

    def serialize(self, state, size=None):
        needed = c_size_t()
        status = self._f("fmi2SerializedFMUstateSize", "fmi3SerializedFMUStateSize")(self.p, state, byref(needed))
        if status != OK:
            return status, b""
        buffer = (c_char * needed.value)()
        n = c_size_t(needed.value if size is None else size)
        status = self._f("fmi2SerializeFMUstate", "fmi3SerializeFMUState")(self.p, state, buffer, n)
        return status, buffer.raw

    def deserialize(self, data):
        state = c_void_p()
        f = self._f("fmi2DeSerializeFMUstate", "fmi3DeserializeFMUState")
        return f(self.p, c_char_p(data), c_size_t(len(data)), byref(state)), state

    # derivatives
    def directional(self, unknowns, knowns, seed, length=None):
        u, k = (c_uint32 * len(unknowns))(*unknowns), (c_uint32 * len(knowns))(*knowns)
        s, out = (c_double * len(seed))(*seed), (c_double * (length or len(unknowns)))()
        head = (self.p, u, c_size_t(len(unknowns)), k, c_size_t(len(knowns)), s)
        if self.v == 2:
            return self.dll.fmi2GetDirectionalDerivative(*head, out), list(out)
        status = self.dll.fmi3GetDirectionalDerivative(*head, c_size_t(len(seed)), out, c_size_t(len(out)))
        return status, list(out)

    def adjoint(self, unknowns, knowns, seed):
        u, k = (c_uint32 * len(unknowns))(*unknowns), (c_uint32 * len(knowns))(*knowns)
        s, out = (c_double * len(seed))(*seed), (c_double * len(knowns))()
        f = self.dll.fmi3GetAdjointDerivative
        tail = (s, c_size_t(len(seed)), out, c_size_t(len(out)))
        return f(self.p, u, c_size_t(len(unknowns)), k, c_size_t(len(knowns)), *tail), list(out)

    def input_derivative(self, name, value, order=1):
        """FMI 2 alone."""
        refs = (c_uint32 * 1)(*self.library.reference(name))
        return self.dll.fmi2SetRealInputDerivatives(self.p, refs, c_size_t(1), (c_int * 1)(order), (c_double * 1)(value))

    def output_derivative(self, name, order=1):
        refs = self.library.reference(name)
        orders, out = (c_int * len(refs))(*[order] * len(refs)), (c_double * self.library.length(name))()
        r = (c_uint32 * len(refs))(*refs)
        head = (self.p, r, c_size_t(len(refs)), orders, out)
        f = self._f("fmi2GetRealOutputDerivatives", "fmi3GetOutputDerivatives")
        return f(*head, *(() if self.v == 2 else (c_size_t(len(out)),))), list(out)


class NULL:
    """Stands for a NULL token, because None stands for the FMU's own."""


H = 1 / 32  # communication step of the tests, s


def stepped(pad, count=4, **values):
    pad.start(**values)
    for i in range(count):
        assert pad.step(i * H, H) == OK
    return pad


def refused(library, **arguments):
    pad = Instance(library, **arguments)
    return pad.c is None and len(pad.log) == 1
