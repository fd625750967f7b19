"""Many runs of one scene."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal

from . import _json, _native
from ._optional import needed

if TYPE_CHECKING:
    import xarray


def sweep(
    scene: _native.SceneLike,
    vary: Mapping[str, Any],
    *,
    sampling: Literal["grid", "list", "latin", "sobol"] = "grid",
    runs: int | None = None,
    seed: int = 0,
    record: Iterable[str] = (),
    workers: int | None = None,
    file: str | os.PathLike[str] | None = None,
    resume: bool = False,
    progress: Callable[[int, int], object] | None = None,
) -> xarray.Dataset:
    """Runs a scene many times with other values, in parallel threads of this process, as the command `stickslip sweep` does.

    Coefficients of friction (`contact.friction.*`) and the run (`run.*`) are varied without compiling; `time.*` and the solver share
    the body; anything else is compiled once for all runs with these values. Results do not depend on the number of workers.

    Args:
        scene: what `Scene` takes.
        vary: for each path of the scene a list or array of values, or a tuple `(from, to, number)`, `(from, to)` to be sampled, either
            with "log" at the end.
        sampling: "grid" (every value with every other one, the last path fastest), "list" (all in step), "latin" (hypercube), "sobol".
        runs: the number of samples of "latin" and "sobol".
        seed: what samples are drawn with.
        record: ports, `"PORT"` (its end), `"PORT:min"`, `"PORT:max"` or `"PORT:mean"` over the run. Default: the ends of all scalar
            outputs.
        workers: number of threads. Default: one per processor.
        file: a table to write too: .csv, .npz or .parquet (needs pyarrow). Rows are kept in `FILE.part` as they come.
        resume: go on with a sweep that was ended, from `FILE.part`.
        progress: called now and then with the runs done and their number; what it raises ends the sweep.

    Returns:
        A Dataset over `run`, with the paths as coordinates and what is recorded as variables; those of a run that failed are nan, and
        `error` says why (empty where nothing went wrong).

    Raises:
        Error: for a path or value that the scene does not allow, a port that is not there. A run that fails raises nothing.
        ImportError: without xarray, or pyarrow where it is needed.

    >>> import stickslip
    >>> results = stickslip.sweep("kazmi2014", {"contact.friction.b": (0.0005, 0.003, 4)}, record=["contact.slip:max"])
    >>> slip = results["contact.slip[32]:max"]
    >>> bool((slip.diff("run") < 0).all())
    True
    """
    xr = needed("xarray", "run")
    path = None if file is None else pathlib.Path(file)
    is_parquet = path is not None and path.suffix == ".parquet"
    if path is not None and path.suffix not in (".csv", ".npz", ".parquet"):
        raise ValueError(f"{path}: a table ends in .csv, .npz or .parquet")
    if is_parquet:
        needed("pyarrow.parquet", "parquet")
    if resume and path is None:
        raise ValueError("resume: needs the file whose sweep is gone on with")
    columns = _native.sweep(
        scene if isinstance(scene, _native.Scene) else _native.Scene(scene),
        [(name, _course(values)) for name, values in vary.items()],
        sampling=sampling,
        runs=runs,
        seed=seed,
        record=list(record),
        workers=workers,
        table=path,
        resume=resume,
        write=not is_parquet,
        progress=progress,
    )
    columns["error"] = [error or "" for error in columns["error"]]
    if path is not None and is_parquet:
        parquet = needed("pyarrow.parquet", "parquet")
        table = needed("pyarrow", "parquet").table({"run": list(range(len(columns["error"]))), **columns})
        parquet.write_table(table, path)
        path.with_name(path.name + ".part").unlink(missing_ok=True)
    coordinates = {name: ("run", columns.pop(name)) for name in vary}
    dataset: xarray.Dataset = xr.Dataset({name: ("run", values) for name, values in columns.items()}, coordinates)
    return dataset


def _course(values: Any) -> str | list[str]:
    """The course of an axis, as the command takes it."""
    if isinstance(values, str):
        return values
    if isinstance(values, tuple):
        numbers, is_log = (values[:-1], True) if values and values[-1] == "log" else (values, False)
        if len(numbers) not in (2, 3):
            raise ValueError(f"a range is (from, to, number) or (from, to), with 'log' at the end or without: found {values!r}")
        texts = [repr(float(number)) for number in numbers[:2]] + [str(int(number)) for number in numbers[2:]]
        return ":".join(texts + ["log"] * is_log)
    return [_json.dumps(value) for value in values]
