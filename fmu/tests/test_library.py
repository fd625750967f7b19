"""The shared library of an FMU as a host sees it: its symbols, and the FMU that the command writes by itself."""

import subprocess
import zipfile

import fmpy
from conftest import BUILD

# functions of FMI 2.0 Co-Simulation and of FMI 3.0, counted in the standard's headers
FUNCTIONS = {"fmi2": 34, "fmi3": 75}


def test_exactly_the_functions_of_the_standards_are_exported(paper, tmp_path):
    """A host that loads several FMUs must not find other names."""
    with zipfile.ZipFile(paper) as archive:
        name = next(n for n in archive.namelist() if n.endswith(".so"))
        library = archive.extract(name, tmp_path)
    done = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True)
    names = [line.split()[2] for line in done.stdout.splitlines()]
    assert {p: sum(n.startswith(p) for n in names) for p in FUNCTIONS} == FUNCTIONS
    assert len(names) == sum(FUNCTIONS.values()), names


def test_the_main_job_writes_an_fmu_that_loads(tmp_path):
    done = subprocess.run([BUILD / "stickslip"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "fmpy.simulate_fmu('out/kazmi2014.fmu'" in done.stdout, done.stdout[-2000:]
    result = fmpy.simulate_fmu(str(tmp_path / "out" / "kazmi2014.fmu"), output=["contact.slip_rate", "contact.stick_fraction"])
    assert result["contact.slip_rate"].shape == (33, 32) and 0 < result["contact.stick_fraction"][-1] < 1
