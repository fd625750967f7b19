"""What the standards ask of capabilities that the FMU claims: derivatives in every mode, stop times, sets of parameters, what depends
on what, and what lies in the file."""

import json
import os
import subprocess
import xml.etree.ElementTree as ElementTree
import zipfile
from ctypes import c_double, c_int, c_int64, c_size_t, c_uint32

import fmpy
import pytest
from conftest import BUILD
from raw import ERROR, H, OK, Instance, Library, stepped
from trajectories import ROOT

A, B = "contact.friction.a", "contact.friction.b"


def by_press(pad, name):
    library = pad.library
    return pad.directional(library.reference(name), library.reference("press"), [1.0], library.length(name))


def test_derivatives_without_a_step_are_those_of_the_instant(pad):
    """In initialization mode, after it, and after a restored state. FMI 2.0.5, 4.2.4; FMI 3.0, 2.3.3."""
    assert pad.setup() == OK and pad.enter() == OK
    before = pad.get("contact.slip_rate")
    status, found = by_press(pad, "contact.slip_rate")
    assert status == OK and min(found) == pytest.approx(-2.0675, abs=1e-3)
    assert pad.get("contact.slip_rate") == before
    d = 1e-6
    assert pad.set("press", -0.3 + d) == OK
    up = pad.get("contact.slip_rate")
    assert pad.set("press", -0.3 - d) == OK
    down = pad.get("contact.slip_rate")
    assert found == pytest.approx([(x - y) / (2 * d) for x, y in zip(up, down)], abs=1e-4)
    assert pad.set("press", -0.3) == OK and pad.exit() == OK
    assert by_press(pad, "contact.slip_rate") == (OK, found)
    if pad.v == 3:
        library = pad.library
        weights = [1.0 + i for i in range(len(found))]
        status, back = pad.adjoint(library.reference("contact.slip_rate"), library.reference("press"), weights)
        assert status == OK and back[0] == pytest.approx(sum(w * x for w, x in zip(weights, found)))
    assert pad.step(0.0, H) == OK
    stepping = by_press(pad, "contact.slip")
    assert stepping[0] == OK and any(stepping[1])
    assert pad.restore(pad.save()[1]) == OK
    status, found = by_press(pad, "contact.slip_rate")
    assert status == OK and min(found) < -1.0
    assert by_press(pad, "contact.slip") == (OK, [0.0] * len(found))


def test_every_output_has_a_derivative_by_time(library, pad):
    """maxOutputDerivativeOrder is 1: a value, or 0 where it is not known; FMI 2.0.5, 4.2.1."""
    stepped(pad)
    for name in dict.fromkeys(n.split("[")[0] for n, v in library.variables.items() if v.causality == "output"):
        status, slope = pad.output_derivative(name)
        assert status == OK, (name, pad.log)
        if name.endswith(".displacement"):
            assert slope == pad.get(name.replace(".displacement", ".velocity"))
        elif name not in ("contact.slip", "contact.accumulated_slip"):
            assert not any(slope), name
    assert pad.output_derivative("contact.slip")[1] == pad.get("contact.slip_rate") != [0.0] * 32
    assert pad.output_derivative("press")[0] == ERROR and pad.output_derivative("contact.slip", order=2)[0] == ERROR


def test_steps_past_the_stop_time_are_errors(pad):
    """Rounding of accumulated steps is none; FMI 2.0.5, 2.1.6; FMI 3.0, 2.3.2."""
    assert pad.setup(0.0, stop=1.0) == OK and pad.enter() == OK and pad.exit() == OK
    t = 0.0
    for _ in range(100):
        assert pad.step(t, 0.01) == OK
        t += 0.01
    assert t > 1.0
    before = pad.everything()
    assert pad.step(t, 0.01) == ERROR and "stop time 1" in pad.log[-1][3]
    assert pad.everything() == before
    # the stop time belongs to the state
    data = pad.serialize(pad.save()[1])[1]
    other = Instance(pad.library)
    assert other.restore(other.deserialize(data)[1]) == OK and other.step(t, 0.01) == ERROR
    other.free()
    assert pad.reset() == OK and pad.setup(0.0, stop=1.0) == OK and pad.enter() == OK and pad.exit() == OK
    assert pad.step(0.0, 1.5) == ERROR and pad.step(0.0, 1.0) == OK
    assert pad.reset() == OK and pad.start().step(0.0, 1.5) == OK


@pytest.mark.parametrize("stop", [0.5, float("nan"), float("inf")])
def test_a_stop_time_before_the_start_is_refused(library, pad, stop):
    set_up = pad.setup(1.0, stop=stop)
    assert (set_up if library.version == 2 else pad.enter()) == ERROR
    assert "stop time" in pad.log[-1][3]
    assert pad.start().step(0.0, H) == OK


@pytest.mark.parametrize("pair", [(5e-4, 2e-4), (9e-3, 4e-3), (0.01, 0.01)])
@pytest.mark.parametrize("order", [(A, B), (B, A)])
def test_coefficients_are_set_in_any_order(paper, library, pad, pair, order):
    values = dict(zip((A, B), pair))
    fmpy.simulate_fmu(str(paper), stop_time=0.1, start_values={name: values[name] for name in order})
    assert all(pad.set(name, values[name]) == OK for name in order)
    once = stepped(pad).everything()
    assert pad.reset() == OK
    assert pad.set_refs([library.reference(n)[0] for n in order], [values[n] for n in order]) == OK
    assert stepped(pad).everything() == once
    # between steps too
    assert pad.set(A, 0.003) == OK and pad.set(B, 0.001) == OK and pad.step(4 * H, H) == OK
    assert all(pad.set(name, values[name]) == OK for name in order) and pad.step(5 * H, H) == OK


def test_coefficients_that_do_not_fit_are_refused_where_the_set_is_complete(pad):
    assert pad.setup() == OK and pad.enter() == OK
    assert pad.set(B, 0.01) == OK
    assert pad.exit() == ERROR and "contact.friction" in pad.log[-1][3]
    assert pad.set(A, 0.02) == OK and pad.exit() == OK and pad.step(0.0, H) == OK
    before = pad.everything()
    assert pad.set(A, 0.001) == OK
    assert pad.step(H, H) == ERROR and "contact.friction" in pad.log[-1][3]
    assert pad.everything() == before
    assert pad.set(B, 0.0005) == OK and pad.step(H, H) == OK


def test_enumerations_as_numbers_and_fixed_parameters_in_step_mode_are_refused_by_name(library):
    """What some importers try; whatever they log."""
    pad = Instance(library, logging=False)
    assert pad.set("time.scheme", 2.0) == ERROR and "time.scheme" in pad.log[-1][3] and "enumeration" in pad.log[-1][3]
    stepped(pad)
    assert pad.set("time.step", 0.01) == ERROR and "time.step is a fixed parameter" in pad.log[-1][3]
    refs, one = (c_uint32 * 1)(*library.reference("time.step")), c_size_t(1)
    if library.version == 2:
        assert library.dll.fmi2SetInteger(pad.p, refs, one, (c_int * 1)(1)) == ERROR
    else:
        assert library.dll.fmi3SetInt64(pad.p, refs, one, (c_int64 * 1)(1), one) == ERROR
    assert "time.step" in pad.log[-1][3] and "number" in pad.log[-1][3]
    assert pad.get("time.step") == [1 / 32]
    pad.free()


@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d", "seal"])
def test_declared_dependencies_are_those_of_the_derivatives(pack, version, scene):
    """Velocities and contact forces follow the loads of the instant; displacements, slips and energies do not."""
    library = Library(pack(scene, version))
    pad = Instance(library)
    assert pad.setup() == OK and pad.enter() == OK
    variables = library.variables
    loads = [n for n, v in variables.items() if v.causality == "input"]
    assert pad.set(loads[0], -0.3 if scene == "kazmi2014" else 2e5) == OK
    structure = library.description
    declared = {}
    for phase, unknowns in (("step", structure.outputs), ("start", structure.initialUnknowns)):
        for unknown in unknowns:
            assert unknown.dependencies is not None
            stem = unknown.variable.name.split("[")[0]
            declared.setdefault((phase, stem), set()).update(v.name for v in unknown.dependencies)
    outputs = dict.fromkeys(n.split("[")[0] for n, v in variables.items() if v.causality == "output")
    follow = 0
    for name in outputs:
        status, found = pad.directional(library.reference(name), library.reference(loads[0]), [1.0], library.length(name))
        assert status == OK
        is_integral = name.startswith("energy.") or name.endswith((".slip", ".accumulated_slip", ".displacement"))
        if is_integral:
            assert not declared["step", name] and not declared["start", name] and not any(found), name
        elif name != "solver.error_estimate":
            assert declared["step", name] == set(loads), name
            assert set(loads) < declared["start", name], name
            assert {"time.step", "time.scheme", "time.tolerance", "time.inputs"}.isdisjoint(declared["start", name])
        follow += any(found)
    assert follow >= 3
    pad.free()
    library.close()


LICENCE = "MIT"


def test_the_file_carries_the_licence_of_the_project(paper):
    with zipfile.ZipFile(paper) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        assert root.get("license") == LICENCE
        assert archive.read("documentation/licenses/license.txt").decode() == (ROOT / "LICENSE").read_text()
        notices = archive.read("documentation/licenses/THIRD-PARTY-NOTICES.txt").decode()
    assert notices == (ROOT / "THIRD-PARTY-NOTICES.txt").read_text() and "zip " in notices


def test_the_manifest_names_the_reference_results(paper):
    folder = "extra/org.fmi-standard.fmi-ls-ref"
    namespace = "{http://fmi-standard.org/fmi-ls-manifest}"
    with zipfile.ZipFile(paper) as archive:
        root = ElementTree.fromstring(archive.read(f"{folder}/fmi-ls-manifest.xml"))
        assert root.tag == "fmiReferences"
        assert root.get(f"{namespace}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref" and root.get(f"{namespace}fmi-ls-version")
        found = {related.get("role"): related.get("source") for related in root.findall("Related")}
        assert set(found) == {"stimulus", "result"}
        for source in found.values():
            assert archive.read(f"{folder}/{source}").startswith(b"time,")


def packed(path, version, epoch):
    environment = {**os.environ, "SOURCE_DATE_EPOCH": epoch}
    command = [BUILD / "stickslip", "fmu", "kazmi2014", "-o", path, "--fmi", version]
    return subprocess.run(command, env=environment, capture_output=True, text=True)


def test_two_packages_of_one_scene_are_the_same_bytes(tmp_path, version):
    for name in "ab":
        done = packed(tmp_path / name, version, "86400")
        assert done.returncode == 0, done.stderr
    first = (tmp_path / "a").read_bytes()
    assert first == (tmp_path / "b").read_bytes()
    with zipfile.ZipFile(tmp_path / "a") as archive:
        assert b'generationDateAndTime="1970-01-02T00:00:00Z"' in archive.read("modelDescription.xml")


@pytest.mark.parametrize("epoch", ["soon", "-1", "1.5", "99999999999999999999"])
def test_a_date_that_is_none_is_refused(tmp_path, version, epoch):
    done = packed(tmp_path / "x", version, epoch)
    assert done.returncode != 0 and "SOURCE_DATE_EPOCH" in done.stderr and not (tmp_path / "x").exists()


def test_a_tolerance_of_the_importer_is_that_of_scenes_with_chosen_steps(pack, version, tmp_path, pad):
    scene = json.loads((ROOT / "src/scene/examples/kazmi2014.json").read_text())
    scene["time"]["tolerance"] = 1e-2
    path = tmp_path / "tolerant.json"
    path.write_text(json.dumps(scene))
    library = Library(pack(path, version))
    assert float(library.description.defaultExperiment.tolerance) == 1e-2
    other = Instance(library)
    assert other.setup(tolerance=1e-4) == OK and other.enter() == OK and other.get("time.tolerance") == [1e-4]
    other.free()
    library.close()
    # equal steps have no tolerance
    assert pad.library.description.defaultExperiment.tolerance is None
    assert pad.setup(tolerance=1e-4) == OK and pad.enter() == OK and pad.get("time.tolerance") == [0.0]
