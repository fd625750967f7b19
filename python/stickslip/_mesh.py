"""The body as meshes of meshio and pyvista."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._native import Model, Simulator, State
from ._optional import needed

if TYPE_CHECKING:
    import meshio
    import pyvista

    from ._native import Array

# names of meshio for the numbers of VTK
CELLS = {5: "triangle", 22: "triangle6", 10: "tetra", 24: "tetra10"}


def to_meshio(model: Model, state: State | Simulator | None = None, fields: Mapping[str, Array] | None = None) -> meshio.Mesh:
    """The mesh of a model in its undeformed shape, z = 0 in 2D, with the region of every cell.

    Args:
        model: the compiled scene.
        state: whose `displacement` (m) and `velocity` (m/s) become point data, and for a simulator the contact's ports of one value
            per node too (nan off the contact).
        fields: more point data, each (mesh nodes,) or (mesh nodes, components).

    Raises:
        ImportError: without meshio.

    >>> import stickslip
    >>> stickslip.to_meshio(stickslip.compile("kazmi2014")).cells[0].type
    'triangle'
    """
    meshio = needed("meshio", "mesh")
    mesh = model.mesh()
    cells = [(CELLS[mesh["vtk_type"]], mesh["cells"])]
    return meshio.Mesh(_solid(mesh["points"]), cells, _point_data(model, state, fields), {"region": [mesh["cell_region"]]})


def to_pyvista(
    model: Model,
    state: State | Simulator | None = None,
    fields: Mapping[str, Array] | None = None,
    *,
    warp: float = 0.0,
) -> pyvista.UnstructuredGrid:
    """The same as a grid of pyvista; `warp` times the displacement moves its points.

    Raises:
        ImportError: without pyvista.
    """
    pyvista = needed("pyvista", "mesh")
    mesh = model.mesh()
    data = _point_data(model, state, fields)
    points = _solid(mesh["points"])
    if warp:
        points = points + warp * data["displacement"]
    grid = pyvista.UnstructuredGrid({mesh["vtk_type"]: mesh["cells"]}, points)
    for name, values in data.items():
        grid.point_data[name] = values
    grid.cell_data["region"] = mesh["cell_region"]
    return grid


def _solid(points: Array) -> Array:
    """Points or vectors of three components."""
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def _point_data(model: Model, state: State | Simulator | None, fields: Mapping[str, Array] | None) -> dict[str, Any]:
    data: dict[str, Any] = {}
    if state is not None:
        saved = state.save() if isinstance(state, Simulator) else state
        data["displacement"] = _solid(model.displacement(saved))
        data["velocity"] = _solid(model.velocity(saved))
    if isinstance(state, Simulator):
        contact, leader = model.contact["node"], model.mesh()["leader"]
        for port in model.ports:
            if port.causality == "output" and port.name.startswith("contact.") and port.shape == contact.shape:
                nodal = np.full(len(leader), np.nan)
                nodal[contact] = state[port.name]
                data[port.name] = nodal[leader]
    data.update(fields or {})
    return data
