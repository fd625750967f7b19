"""Runs of a scene on its own signals, as labelled arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from . import _native
from ._native import Model, Simulator, State, compile, follow
from ._optional import needed

if TYPE_CHECKING:
    import xarray

AXES = ("x", "y", "z")


def run(
    scene: _native.SceneLike | Model | Simulator,
    *,
    until: float | None = None,
    step: float | None = None,
    signals: Mapping[str, Any] | None = None,
    outputs: Iterable[str] | None = None,
    fields: bool = False,
    state: State | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> xarray.Dataset:
    """Steps a scene on its own signals; one row per communication point, the start included, and one where a signal jumps.

    Args:
        scene: what `Scene` takes, or a compiled `Model` (the run is that of its scene), or a `Simulator`: one that has just been made
            or reset begins, one that is initialized goes on from where it stands. It is left at the end of the run.
        until: end of the run, s. Default: `run.until` of the scene.
        step: communication step, s. Default: `run.step` of the scene, else `time.step`.
        signals: courses of inputs that replace those of the scene: numbers, or pairs of time and value.
        outputs: the ports to record. Default: all inputs and outputs.
        fields: whether displacement and velocity of all mesh nodes are recorded too.
        state: a saved state to go on from.
        progress: called now and then with the communication points passed and their number; what it raises ends the run.

    Returns:
        A Dataset whose variables are the ports, with `units` and `long_name`. Dimensions: `time` (s), `node` over the contact with
        the coordinates `x`, `y`, `z` (m) and `weight`, `tangent` for the components in 3D, `axis`, and `mesh_node` for fields.

    Raises:
        Error: as `compile` and `Simulator.step` raise it.
        ImportError: without xarray.

    >>> import stickslip
    >>> results = stickslip.run("kazmi2014", until=0.5, outputs=["contact.slip_rate"])
    >>> dict(results.sizes), results["contact.slip_rate"].units, results.time.units
    ({'time': 17, 'node': 32}, 'm/s', 's')
    """
    xr = needed("xarray", "run")
    simulator = _simulator(scene)
    model = simulator.model
    changes: dict[str, Any] = {}
    if until is not None:
        changes["run.until"] = until
    if step is not None:
        changes["run.step"] = step
    if signals is not None:
        changes["run.signals"] = {**model.scene["run.signals"], **signals}
    course = model.scene.with_(changes) if changes else model.scene
    if state is not None:
        simulator.restore(state)
    recorded = [port for port in model.ports if port.causality != "parameter"]
    if outputs is not None:
        recorded = [model.port(name) for name in outputs]
    arrays = follow(simulator, course, [port.name for port in recorded], fields=fields, progress=progress)
    data: dict[str, Any] = {}
    for port in recorded:
        attributes = {"units": port.unit, "long_name": port.description}
        data[port.name] = (("time", *_dimensions(model, port)), arrays[port.name], attributes)
    if fields:
        for name, unit in (("displacement", "m"), ("velocity", "m/s")):
            attributes = {"units": unit, "long_name": f"{name.capitalize()} of the nodes of the mesh."}
            data[name] = (("time", "mesh_node", "axis"), arrays[name], attributes)
    coordinates = _coordinates(model, data)
    coordinates["time"] = ("time", arrays["time"], {"units": "s", "long_name": "Time"})
    attributes = {"scene": course.to_json(), "fingerprint": f"{model.fingerprint:016x}", "title": model.name}
    dataset: xarray.Dataset = xr.Dataset(data, coordinates, attributes)
    return dataset


def _simulator(scene: _native.SceneLike | Model | Simulator) -> Simulator:
    if isinstance(scene, Simulator):
        return scene
    return Simulator(scene if isinstance(scene, Model) else compile(scene))


def _dimensions(model: Model, port: _native.Port) -> tuple[str, ...]:
    """Names of the dimensions of a port."""
    nodes = len(model.contact["node"])
    if not port.shape:
        return ()
    if port.name.startswith("contact."):
        return ("node", "tangent")[: len(port.shape)] if port.shape[0] == nodes else ("tangent",)
    if port.causality == "output":
        return ("axis",)
    return tuple(f"{port.name}.{i}" for i in range(len(port.shape)))


def _coordinates(model: Model, data: Mapping[str, Any]) -> dict[str, Any]:
    """Where the values of the dimensions in use stand."""
    used = {dimension for dimensions, _, _ in data.values() for dimension in dimensions}
    axes = AXES[: model.info["dimension"]]
    found: dict[str, Any] = {}
    if "node" in used:
        contact = model.contact
        for axis, values in zip(axes, contact["position"].T):
            found[axis] = ("node", values, {"units": "m", "long_name": f"{axis} of the contact node"})
        unit = "m" if len(axes) == 2 else "m2"
        found["weight"] = ("node", contact["weight"], {"units": unit, "long_name": "Share of the contact area"})
    if "axis" in used:
        found["axis"] = ("axis", list(axes))
    if "mesh_node" in used:
        for axis, values in zip(axes, model.mesh()["points"].T):
            found[f"mesh_{axis}"] = ("mesh_node", values, {"units": "m", "long_name": f"{axis} of the mesh node"})
    return found
