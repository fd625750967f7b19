"""The exception of the package."""

from __future__ import annotations

import enum
import typing

from ._native import error_codes

if typing.TYPE_CHECKING:

    class ErrorCode(enum.IntEnum):
        """Why a call failed; the numbers are those of C and Rust."""

        SCENE = -1
        BODY = -2
        REDUCTION_INACCURATE = -3
        NOT_CONVERGED = -4
        NOT_POSITIVE_DEFINITE = -5
        STEP = -6
        LENGTH = -7
        VALUE = -8
        UNKNOWN = -9
        CALL_ORDER = -10
        BYTES = -11
        FINGERPRINT = -12
        UNSTABLE = -13
        NULL = -14
        POISONED = -15
        TOLERANCE_OUT_OF_REACH = -16
        CANCELLED = -17
        OVERFLOW = -18

else:
    # all that the library has; the list above, for type checkers, is compared with it by a test
    ErrorCode = enum.IntEnum("ErrorCode", error_codes(), module=__name__)
    ErrorCode.__doc__ = "Why a call failed; the numbers are those of C and Rust."


class Error(Exception):
    """A call that the library refused or could not finish; what it would have changed is as it was.

    >>> import stickslip
    >>> try:
    ...     stickslip.Scene("kazmi2014").with_({"contact.friction.alpha": -1})
    ... except stickslip.Error as error:
    ...     print(error.code.name, error.path, error.found, error.allowed, sep="; ")
    SCENE; contact.friction.alpha; -1; a number >= 0 (Decay, s/m; not negative)

    Attributes:
        code: an `ErrorCode`.
        path: what it is about: the JSON path in a scene, the name of a value; `None` where it says nothing of the kind.
        found: what was found there, text or a number; `None` where the message says all.
        allowed: what is allowed there, or expected.
    """

    code: ErrorCode
    path: str | None
    found: str | float | int | None
    allowed: str | float | int | None

    def __init__(
        self,
        message: str,
        code: int,
        path: str | None = None,
        found: str | float | int | None = None,
        allowed: str | float | int | None = None,
    ) -> None:
        super().__init__(message)
        self.code = ErrorCode(code)
        self.path = path
        self.found = found
        self.allowed = allowed

    def __reduce__(self) -> tuple[type[Error], tuple[typing.Any, ...]]:
        return Error, (self.args[0], int(self.code), self.path, self.found, self.allowed)
