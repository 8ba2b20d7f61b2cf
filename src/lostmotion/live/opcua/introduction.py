"""Trust on first use: what a person looks at, and the fingerprint that he gives or confirms."""

from __future__ import annotations

import hmac
from dataclasses import dataclass
from pathlib import Path

from cryptography import x509

from lostmotion.errors import ParameterError, one_line
from lostmotion.live.opcua.certificates import bare, fingerprint, hosts, uris
from lostmotion.live.opcua.checks import check_form, host_of, names_host
from lostmotion.live.opcua.client import offered
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.opcua.trust import TrustStore

DIGITS = 64  # of SHA-256: a part of it is no fingerprint


@dataclass(frozen=True)
class Introduction:
    """Certificate that a server has shown, not yet believed.

    Attributes
    ----------
    address : str
    certificate : Certificate
    """

    address: str
    certificate: x509.Certificate

    def __str__(self) -> str:
        shown, host = self.certificate, host_of(self.address)
        named = {*hosts(shown)}
        lines = {
            "server": self.address,
            "name": shown.subject.rfc4514_string(),
            "application": ", ".join(uris(shown)),
            "hosts": ", ".join(sorted(named)) or "none",
            "in force": f"{shown.not_valid_before_utc:%Y-%m-%d} to {shown.not_valid_after_utc:%Y-%m-%d}",
            "SHA-256": fingerprint(shown),
        }
        if not names_host(named, host):
            lines["note"] = f"it does not name {host}; you would accept it there"
        return "\n".join(f"{name:<12} {one_line(text)}" for name, text in lines.items())

    def believed(self, store: TrustStore) -> Path:
        """Believe the server at this address from now on; file of its certificate in the store."""
        return store.add(self.certificate, host_of(self.address))

    def refuse_other(self, given: str) -> None:
        """Refuse another fingerprint than the one that the person has from the server's own display.

        Raises
        ------
        ParameterError
            It is no SHA-256.
        RefusedError
            It is another one: somebody else may answer.
        """
        wanted, shown = bare(given), bare(fingerprint(self.certificate))
        if len(wanted) != DIGITS or set(wanted) - set("0123456789ABCDEF"):
            raise ParameterError.expected("--fingerprint with the 64 digits of SHA-256", given, "copy all of it")
        if not hmac.compare_digest(wanted, shown):
            remedy = "check the address; if it is right, look for who answers in its place"
            raise RefusedError.because("untrusted", f"SHA-256 {wanted}", fingerprint(self.certificate), remedy)


async def introduced(address: str) -> Introduction:
    """What the server at an address shows; refused where nobody may trust it.

    Raises
    ------
    RefusedError
        See :func:`offered`, :func:`check_form`.
    FileAccessError
        No such server.
    """
    offer = await offered(address)
    check_form(offer.certificate, offer.uri, address)
    return Introduction(address, offer.certificate)
