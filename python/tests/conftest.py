"""Scenes and models that the tests share."""

from __future__ import annotations

from typing import Any

import pytest

import stickslip


def pad(**changes: Any) -> dict[str, Any]:
    """A small pad pressed on a table; its contact slips and sticks within a second."""
    scene: dict[str, Any] = {
        "schema_version": 1,
        "name": "pad",
        "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"},
        },
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": {"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 100.0}},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, 1], "start": -0.3}],
        "probes": [{"name": "tip", "at": [1.0, 0.0]}],
        "time": {"step": 0.0625},
        "run": {"until": 1.0, "signals": {"press": [[0.0, -0.3], [0.5, -0.3], [0.5, -0.1], [1.0, -0.2]]}},
    }
    return {**scene, **changes}


@pytest.fixture(scope="session")
def model() -> stickslip.Model:
    return stickslip.compile(pad())


@pytest.fixture(scope="session")
def solid() -> stickslip.Model:
    """A pad in three dimensions, whose contact has two tangents."""
    return stickslip.compile(
        stickslip.Scene("brake_pad_3d").with_({"mesh.cells": [4, 2, 3], "run.until": 0.1, "fidelity.model": "condensed"})
    )


@pytest.fixture(scope="session")
def brake() -> stickslip.Model:
    """A pad on a turning disc, driven by displacement, whose contact opens."""
    return stickslip.compile(stickslip.Scene("disc_brake").with_({"mesh.cells": [8, 2], "run.until": 0.2}))


@pytest.fixture
def simulator(model: stickslip.Model) -> stickslip.Simulator:
    """A simulator that has taken a step."""
    simulator = stickslip.Simulator(model)
    simulator.init()
    simulator.step(0.1)
    return simulator
