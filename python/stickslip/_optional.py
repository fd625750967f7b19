"""Packages that only some calls need."""

from __future__ import annotations

import importlib
from typing import Any


def needed(name: str, extra: str) -> Any:
    """The module `name`.

    Raises:
        ImportError: with the command that installs it.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"this needs the package {name}: pip install 'stickslip[{extra}]'", name=name) from error
