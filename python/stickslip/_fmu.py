"""FMUs."""

from __future__ import annotations

import os
import pathlib

from . import _native
from ._library import fmu_library


def pack_fmu(
    scene: _native.SceneLike,
    path: str | os.PathLike[str] | None = None,
    *,
    fmi: int = 3,
    scalar: bool = False,
    library: str | os.PathLike[str] | None = None,
) -> bytes:
    """Packs a scene as an FMU (Co-Simulation) and returns its bytes.

    Args:
        scene: what `Scene` takes. It is compiled, and its own run becomes the default experiment and the reference run.
        path: the file to write too; folders are made.
        fmi: the version of FMI, 2 or 3.
        scalar: FMI 3 with one variable per contact node instead of arrays.
        library: the shared library to pack. Default: that of the package.

    Raises:
        Error: for a scene that is refused or does not run.
        FileNotFoundError: when the package was built without the library and none is given.

    >>> import stickslip
    >>> fmu = stickslip.pack_fmu("sheared_column")
    >>> fmu[:2]
    b'PK'
    """
    packed = _native.pack_fmu(scene, fmi=fmi, scalar=scalar, library=library or fmu_library())
    content = packed["bytes"]
    if path is not None:
        target = pathlib.Path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return content
