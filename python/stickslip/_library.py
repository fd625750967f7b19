"""The FMU library that the package carries."""

from __future__ import annotations

import pathlib


def fmu_library() -> pathlib.Path | None:
    """Its path; `None` where the package was built without."""
    folder = pathlib.Path(__file__).resolve().parent / "lib"
    for name in ("libstickslip_fmu.so", "libstickslip_fmu.dylib", "stickslip_fmu.dll"):
        if (folder / name).is_file():
            return folder / name
    return None
