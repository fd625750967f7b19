"""JSON of Python values as scenes have them."""

from __future__ import annotations

import json
import os
from typing import Any


def _plain(value: Any) -> Any:
    """NumPy numbers and arrays, and paths."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a scene has no {type(value).__name__}")


def dumps(value: Any) -> str:
    """The JSON text of a value; numbers that are not finite are left to the library to refuse."""
    return json.dumps(value, default=_plain)
