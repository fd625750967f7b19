"""stickslip: an embeddable co-simulation component for frictional contact of a viscoelastic body.

A `Scene` (plain data) is compiled into a `Model` (immutable, shared); a `Simulator` holds the state and is stepped by its master.
`run` steps a scene on its own signals into an xarray Dataset; `sweep` runs many. All units are SI, per metre of depth in 2D.

>>> import stickslip
>>> results = stickslip.run("kazmi2014")
>>> round(float(results["tip.displacement"].isel(time=-1, axis=0)), 4)
0.1186
"""

from ._error import Error, ErrorCode
from ._fmu import pack_fmu
from ._mesh import to_meshio, to_pyvista
from ._native import Model, Port, Scene, Simulator, State, compile, example_names, json_schema, step_many
from ._run import run
from ._sweep import sweep

__all__ = [
    "Error",
    "ErrorCode",
    "Model",
    "Port",
    "Scene",
    "Simulator",
    "State",
    "compile",
    "example_names",
    "json_schema",
    "pack_fmu",
    "run",
    "step_many",
    "sweep",
    "to_meshio",
    "to_pyvista",
]
