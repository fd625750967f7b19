"""The shared library of an FMU as a host sees it: its symbols, what it asks of the system, and the FMU that the command writes by itself."""

import re
import subprocess
import zipfile

import fmpy
import pytest
from conftest import BUILD, run
from test_trajectories import check_bits

# functions of FMI 2.0 Co-Simulation and of FMI 3.0, counted in the standard's headers
FUNCTIONS = {"fmi2": 34, "fmi3": 75}
# CentOS 7, the oldest system that scripts/portable_fmu.sh builds for
OLDEST = (2, 17)
LIBRARIES = {"native": BUILD / "deps" / "libstickslip_fmu.so", "portable": BUILD / "portable" / "libstickslip_fmu.so"}


def library_of(fmu, folder):
    with zipfile.ZipFile(fmu) as archive:
        name = next(n for n in archive.namelist() if n.endswith(".so"))
        return archive.extract(name, folder)


def glibc_of(library):
    """Newest version of glibc among the symbols that a library asks for."""
    symbols = run("objdump", "-T", library)
    return max(tuple(int(x) for x in v.split(".")) for v in re.findall(r"\(GLIBC_([\d.]+)\)", symbols))


def test_exactly_the_functions_of_the_standards_are_exported(paper, tmp_path):
    """A host that loads several FMUs must not find other names."""
    symbols = run("nm", "-D", "--defined-only", library_of(paper, tmp_path))
    names = [line.split()[2] for line in symbols.splitlines()]
    assert {p: sum(n.startswith(p) for n in names) for p in FUNCTIONS} == FUNCTIONS
    assert len(names) == sum(FUNCTIONS.values()), names


@pytest.mark.parametrize("kind", LIBRARIES)
def test_what_a_library_needs_is_told_and_it_runs_bit_for_bit(kind, version, tmp_path):
    """The command and the documentation state the glibc that the linker will ask for; the run equals that of the packager."""
    library = LIBRARIES[kind]
    if not library.is_file() or library.stat().st_mtime_ns < LIBRARIES["native"].stat().st_mtime_ns:
        pytest.skip(f"{library} is not built, or older than the native one: scripts/portable_fmu.sh")
    fmu = tmp_path / "pad.fmu"
    told = run(BUILD / "stickslip", "fmu", "kazmi2014", "-o", fmu, "--fmi", version, "--library", library)
    needed = glibc_of(library_of(fmu, tmp_path))
    words = f"needs glibc {'.'.join(map(str, needed))} or newer"
    assert f"{kind} library" in told and words in told
    with zipfile.ZipFile(fmu) as archive:
        assert words in archive.read("documentation/index.html").decode()
    if kind == "portable":
        assert needed <= OLDEST
    check_bits(fmu)


def test_the_library_built_last_is_packed(paper, tmp_path):
    found = [path for path in LIBRARIES.values() if path.is_file()]
    newest = max(found, key=lambda path: (path.stat().st_mtime_ns, path == LIBRARIES["portable"]))
    with open(library_of(paper, tmp_path), "rb") as packed:
        assert packed.read() == newest.read_bytes()


def test_the_main_job_writes_an_fmu_that_loads(tmp_path):
    done = subprocess.run([BUILD / "stickslip"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "fmpy.simulate_fmu('out/kazmi2014.fmu'" in done.stdout, done.stdout[-2000:]
    result = fmpy.simulate_fmu(str(tmp_path / "out" / "kazmi2014.fmu"), output=["contact.slip_rate", "contact.stick_fraction"])
    assert result["contact.slip_rate"].shape == (33, 32) and 0 < result["contact.stick_fraction"][-1] < 1
