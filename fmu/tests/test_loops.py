"""The loops of fmu/loops: each runs, holds its own checks and draws; steps that are refused; the sweep on a Dask cluster."""

import json
import math
import os
import pty
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import BUILD

LOOPS = Path(__file__).parents[1] / "loops"
ENVIRONMENT = {**os.environ, "STICKSLIP_BUILD": str(BUILD)}
sys.path.insert(0, str(LOOPS))
import explicit_actuator  # noqa: E402


def loop(name, fmu, out):
    return [sys.executable, LOOPS / f"{name}.py", "--fmu", fmu, "--out", out]


@pytest.mark.parametrize("name", ["explicit_actuator", "implicit_mass", "variable_steps"])
def test_loop_holds_its_checks_and_draws(pack, name, tmp_path):
    done = subprocess.run(loop(name, pack("kazmi2014", "3"), tmp_path), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("ok  ") >= 3 and "FAIL" not in done.stdout
    assert (tmp_path / f"{name}.png").stat().st_size > 20_000


def test_floor_of_the_importer_is_measured(tmp_path):
    """Both versions, every contact value read; the figures themselves are the machine's, and may be anything on a busy one."""
    command = [sys.executable, LOOPS / "importer_floor.py", "--out", tmp_path, "--steps", "10"]
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines()[1:]]
    assert [row[:2] for row in rows] == [["2", "160"], ["3", "160"]]
    assert all(len(row) == 6 and math.isfinite(float(x)) for row in rows for x in row)


def test_refused_steps_are_halved(pack, tmp_path):
    """With less and less iterations the pad refuses steps at last; the loop goes on, by less than its error in time."""
    scene = json.loads((LOOPS.parents[1] / "src/scene/examples/kazmi2014.json").read_text())
    scene["loads"][0]["start"], scene["run"]["signals"] = 0.0, {}
    h = 1 / 32
    free, _, refused = explicit_actuator.run(pack("kazmi2014", "3"), h)
    assert refused == 0
    fine = {row[0]: row[2] for row in explicit_actuator.run(pack("kazmi2014", "3"), h / 16)[0]}
    error = max(abs(row[2] - fine[row[0]]) for row in free)
    for most in range(24, 5, -1):
        scene["fidelity"]["solver"] = {"kind": "newton", "max_iterations": most}
        path = tmp_path / f"at_most_{most}.json"
        path.write_text(json.dumps(scene))
        rows, _, refused = explicit_actuator.run(pack(path, "3"), h)
        if refused:
            break
    assert refused and max(abs(a[2] - b[2]) for a, b in zip(rows, free)) < error


def on_a_terminal(command, **options):
    """Exit status and all that a command writes to its terminal."""
    leader, follower = pty.openpty()
    process = subprocess.Popen(command, stdout=follower, stderr=follower, stdin=follower, **options)
    os.close(follower)
    text = b""
    while True:
        try:
            part = os.read(leader, 65536)
        except OSError:  # how a terminal without writers ends
            break
        if not part:
            break
        text += part
    os.close(leader)
    return process.wait(), text.decode()


@pytest.fixture
def cluster(tmp_path):
    """Address of a scheduler with two workers, processes of their own that know nothing of this folder."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}

    def start(part, *options):
        command = [sys.executable, "-m", "dask", part, "--scheduler-file", file, "--no-dashboard", *options]
        return subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    processes = [start("scheduler", "--host", "127.0.0.1", "--port", "0")]
    processes += [start("worker", "--nthreads", "1", "--no-nanny", "--death-timeout", "3600") for _ in range(2)]
    while not file.is_file() or not file.read_text().strip():
        assert processes[0].poll() is None
        time.sleep(0.1)
    yield json.loads(file.read_text())["address"]
    processes[0].terminate()  # the workers follow their scheduler
    for process in processes:
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def check_sweep(status, text):
    assert status == 0, text
    assert text.count("ok  ") == 3
    # the bar grows: one state of it per point, the last one full
    assert all(f" {done}/36" in text for done in range(1, 37)) and f"[{'#' * 40}] 36/36" in text


def test_sweep_on_this_machine_shows_its_progress(pack, tmp_path):
    check_sweep(*on_a_terminal(loop("sweep", pack("kazmi2014", "3"), tmp_path)))


def test_sweep_on_a_dask_cluster_shows_its_progress(pack, tmp_path, cluster):
    check_sweep(*on_a_terminal([*loop("sweep", pack("kazmi2014", "3"), tmp_path), "--dask", cluster]))
