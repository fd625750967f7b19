"""Every trajectory of tests/reference through FMPy equals the Rust run bit for bit, and the reference within tolerance.

The Rust run is the one that the packager makes and puts into the FMU.
"""

import fmpy
import numpy as np
import pytest
from trajectories import FIELDS, REFERENCES, fmpy_run, rust_run


def check_bits(fmu):
    inputs, (names, *expected) = rust_run(fmu)
    found = fmpy_run(fmu, inputs)
    assert np.array(found).tobytes() == np.array(expected).tobytes()
    return names, expected


@pytest.mark.parametrize("kind", ["2", "3", "3 scalar"])
@pytest.mark.parametrize("scene", ["kazmi2014", "brake_pad_3d", "seal", "sheared_column"])
def test_examples_run_bit_for_bit(pack, scene, kind):
    check_bits(pack(scene, kind))


@pytest.mark.parametrize("name", REFERENCES)
def test_reference_trajectories_run_bit_for_bit(pack_trajectory, version, name):
    reference = REFERENCES[name]
    header, rows = check_bits(pack_trajectory(name, version))
    step = reference["step_size"]
    for field in FIELDS:
        columns = [i for i, name in enumerate(header) if name.startswith(f"contact.{field}[")]
        pairs = [(rows[round(s["t"] / step)], s[field]) for s in reference["samples"]]
        error = max(abs(row[c] - x) for row, xs in pairs for c, x in zip(columns, xs))
        assert error <= 1e-6 * max(abs(x) for _, xs in pairs for x in xs)


def test_packed_files_are_valid(pack):
    for scene in ("kazmi2014", "brake_pad_3d"):
        for kind in ("2", "3", "3 scalar"):
            assert fmpy.validation.validate_fmu(str(pack(scene, kind))) == []
