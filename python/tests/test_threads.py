"""Simulators on threads."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from conftest import pad

import stickslip


def simulators(model: stickslip.Model, count: int) -> list[stickslip.Simulator]:
    made = [stickslip.Simulator(model) for _ in range(count)]
    for simulator in made:
        simulator.init()
    return made


def test_threads_step_simulators_of_their_own(model: stickslip.Model) -> None:
    def work(simulator: stickslip.Simulator, press: float) -> None:
        for _ in range(20):
            simulator["press"] = press
            simulator.step(0.05)

    presses = [-0.1 * i for i in range(1, 5)]
    together, alone = simulators(model, 4), simulators(model, 4)
    threads = [threading.Thread(target=work, args=job) for job in zip(together, presses)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for job in zip(alone, presses):
        work(*job)
    assert [s.save() for s in together] == [s.save() for s in alone]
    assert len({s["tip.displacement"][0] for s in together}) == 4


def test_a_simulator_in_use_refuses_another_thread(model: stickslip.Model) -> None:
    """While a run reports its progress its simulator is in use; the interpreter is not."""
    simulator = stickslip.Simulator(model)
    caught: list[BaseException] = []

    def intrude() -> None:
        try:
            simulator.step(0.1)
        except stickslip.Error as error:
            caught.append(error)

    def progress(passed: int, count: int) -> None:
        thread = threading.Thread(target=intrude)
        thread.start()
        thread.join()

    stickslip.run(simulator, progress=progress)
    assert caught and all(isinstance(e, stickslip.Error) and e.code is stickslip.ErrorCode.CALL_ORDER for e in caught)
    assert "in use by another thread" in str(caught[0])
    assert simulator.time == 1.0


def test_other_threads_run_while_a_scene_is_compiled() -> None:
    """A thread that waits for the compilation to report is let through: the lock of the interpreter is free in between."""
    reported, answered = threading.Event(), threading.Event()

    def answer() -> None:
        reported.wait(60)
        answered.set()

    thread = threading.Thread(target=answer)
    thread.start()

    def progress(phase: str, fraction: float) -> None:
        reported.set()
        assert answered.wait(60)

    stickslip.compile(pad(), progress=progress)
    thread.join()


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_many_are_stepped_in_one_call(model: stickslip.Model, threads: int) -> None:
    many, single = simulators(model, 5), simulators(model, 5)
    view = many[2].view("contact.slip_rate")
    inputs = np.linspace(-0.1, -0.5, 5)[:, None]
    for _ in range(3):
        stickslip.step_many(many, 0.05, inputs=inputs, threads=threads)
        for simulator, row in zip(single, inputs):
            simulator.set_inputs(row)
            simulator.step(0.05)
    assert [s.save() for s in many] == [s.save() for s in single]
    assert np.array_equal(view, single[2]["contact.slip_rate"]) and abs(view).max() > 0


def test_who_fails_among_many_stays(model: stickslip.Model) -> None:
    many = simulators(model, 3)
    many[1].reset()
    with pytest.raises(stickslip.Error, match="^simulator 1: ") as caught:
        stickslip.step_many(many, 0.05, threads=2)
    assert caught.value.code is stickslip.ErrorCode.CALL_ORDER
    assert [s.time for s in many] == [0.05, 0.0, 0.05]
    with pytest.raises(stickslip.Error) as caught:
        stickslip.step_many(many, 0.05, inputs=[[0.0]])
    assert caught.value.code is stickslip.ErrorCode.LENGTH
    with pytest.raises(stickslip.Error, match="in use"):
        stickslip.step_many([many[0], many[0]], 0.05)
    with pytest.raises(ValueError):
        stickslip.step_many(many, 0.05, threads=0)
    stickslip.step_many([], 0.05)
