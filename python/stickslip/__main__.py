"""`python -m stickslip`: the command."""

from ._command import main

main()
