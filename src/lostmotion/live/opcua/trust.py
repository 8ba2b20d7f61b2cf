"""Which servers are believed: a folder of certificates, filled by an explicit command or by hand.

::

    PKI/own/certificate.der, key.pem   ours
    PKI/trusted/*.der, *.pem           servers
    PKI/trusted/FINGERPRINT.json       hosts by which a person has accepted this server, beside those in its certificate
    PKI/authorities/*.der, *.pem       whoever they have signed is believed, put there by hand
    PKI/crl/*.crl, *.der, *.pem        what an authority has revoked; an authority without its list is not believed
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.serialization import Encoding

from lostmotion.errors import FileAccessError
from lostmotion.files.schema import parsed
from lostmotion.files.writer import write_folder
from lostmotion.live.opcua.certificates import DAMAGED, bare, fingerprint, read_certificate
from lostmotion.live.opcua.refusal import RefusedError

CERTIFICATES, LISTS = (".der", ".pem", ".crt", ".cer"), (".crl", ".der", ".pem")


@dataclass(frozen=True)
class TrustStore:
    """Servers that are believed; read anew at each look, so that what is taken out is out.

    Attributes
    ----------
    folder : Path
        Need not exist: then nobody is believed.
    """

    folder: Path

    def refuse_untrusted(self, certificate: x509.Certificate, host: str, address: str) -> None:
        """Refuse a certificate that is neither in the store nor of an authority in it.

        Raises
        ------
        RefusedError
            untrusted; changed: the host was accepted with another one; revoked, unlisted: what its authority says.
        """
        if certificate in self._certificates("trusted"):
            return
        issuer = next((one for one in self._certificates("authorities") if _issued(certificate, one)), None)
        if issuer is not None:
            self._refuse_revoked(certificate, issuer)
            return
        shown = f"SHA-256 {fingerprint(certificate)}"
        if host in {name for path in self.folder.glob("trusted/*.json") for name in _accepted(path)}:
            remedy = f"ask who changed it; only then lostmotion live --trust {address}"
            raise RefusedError.because("changed", f"the certificate that was trusted for {host}", shown, remedy)
        remedy = f"compare this with the server's own display, then lostmotion live --trust {address}"
        raise RefusedError.because("untrusted", f"a trusted certificate of {address}", shown, remedy)

    def hosts_of(self, certificate: x509.Certificate) -> set[str]:
        """Hosts by which a person has accepted a certificate, beside those that it names."""
        return _accepted(self.folder / "trusted" / f"{bare(fingerprint(certificate))}.json")

    def add(self, certificate: x509.Certificate, host: str) -> Path:
        """Believe a server under one more host from now on.

        Returns
        -------
        Path
            File of its certificate; removing it takes the trust back.
        """
        name = bare(fingerprint(certificate))
        known = sorted({*self.hosts_of(certificate), host})
        files = {f"{name}.der": certificate.public_bytes(Encoding.DER), f"{name}.json": json.dumps(known).encode()}
        return write_folder(self.folder / "trusted", files, force=True)[0]

    def _certificates(self, kind: str) -> Iterator[x509.Certificate]:
        for path in _files(self.folder / kind, CERTIFICATES):
            yield read_certificate(path)

    def _refuse_revoked(self, certificate: x509.Certificate, issuer: x509.Certificate) -> None:
        mine = [one for one in self._lists() if _signed(one, issuer)]
        now = datetime.now(UTC)
        current = [one for one in mine if one.next_update_utc is None or one.next_update_utc > now]
        if any(one.get_revoked_certificate_by_serial_number(certificate.serial_number) for one in mine):
            said = f"{fingerprint(certificate)}, which its authority has revoked"
            raise RefusedError.because("revoked", "a certificate in force", said, "ask the owner of the server")
        if not current:
            who, got = issuer.subject.rfc4514_string(), "an old one" if mine else "none"
            raise RefusedError.because(
                "unlisted", f"a current revocation list of {who}", got, f"put it into {self.folder / 'crl'}"
            )

    def _lists(self) -> Iterator[x509.CertificateRevocationList]:
        for path in _files(self.folder / "crl", LISTS):
            data = path.read_bytes()
            try:
                pem = data.lstrip().startswith(b"-----")
                yield x509.load_pem_x509_crl(data) if pem else x509.load_der_x509_crl(data)
            except DAMAGED as error:
                raise FileAccessError(f"expected a revocation list, got something else in {path}; check it") from error


def _files(folder: Path, endings: tuple[str, ...]) -> list[Path]:
    return sorted(path for path in folder.glob("*") if path.suffix.lower() in endings)


def _accepted(path: Path) -> set[str]:
    """Hosts in a file beside a certificate; none where it is not there."""
    try:
        names = parsed(path.read_bytes())
    except FileNotFoundError:
        return set()
    except (OSError, ValueError) as error:
        raise FileAccessError(f"expected a JSON list of hosts in {path}, got something else; remove it") from error
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise FileAccessError(f"expected a JSON list of hosts in {path}, got something else; remove it")
    return set(names)


def _issued(certificate: x509.Certificate, issuer: x509.Certificate) -> bool:
    """Whether an authority in force has signed a certificate."""
    try:
        constraints = issuer.extensions.get_extension_for_class(x509.BasicConstraints).value
        certificate.verify_directly_issued_by(issuer)
    except (x509.ExtensionNotFound, InvalidSignature, TypeError, *DAMAGED):
        return False
    return constraints.ca and issuer.not_valid_before_utc < datetime.now(UTC) < issuer.not_valid_after_utc


def _signed(revoked: x509.CertificateRevocationList, issuer: x509.Certificate) -> bool:
    return revoked.issuer == issuer.subject and revoked.is_signature_valid(issuer.public_key())  # type: ignore[arg-type]
