"""Why a link was not made, as a word that programs test and a line that says what to do."""

from __future__ import annotations

from typing import Self

from lostmotion.errors import FileAccessError, one_line


class RefusedError(FileAccessError):
    """A server that could be reached was not believed, or did not believe us; trying again does not help.

    Attributes
    ----------
    reason : str
        One word for it: untrusted, changed, expired, early, uri, host, key, use, revoked, policy, user, client, ..
    """

    reason = ""

    @classmethod
    def because(cls, reason: str, expected: str, got: object, remedy: str) -> Self:
        """Build the message "expected X, got Y; do Z".

        Examples
        --------
        >>> raise RefusedError.because("host", "a certificate for plc1", "plc2", "check the address")
        Traceback (most recent call last):
        ...
        lostmotion.live.opcua.refusal.RefusedError: expected a certificate for plc1, got plc2; check the address
        """
        error = cls(f"expected {one_line(expected)}, got {one_line(str(got))}; {one_line(remedy)}")
        error.reason = reason
        return error
