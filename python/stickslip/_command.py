"""The command `stickslip`, with the FMU library of the package."""

from __future__ import annotations

import signal
import sys

from ._library import fmu_library
from ._native import command


def main() -> None:
    """Runs the command line of this process and exits with its status."""
    # the command has no Python in it that would see the signal
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(command(["stickslip", *sys.argv[1:]], fmu_library()))


if __name__ == "__main__":
    main()
