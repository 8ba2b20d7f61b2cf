"""Certificates of applications (OPC 10000-6, 6.2): ours, made on first use, and what is read out of others."""

from __future__ import annotations

import ipaddress
import os
import platform
import stat
import sys
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.exceptions import UnsupportedAlgorithm
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import rsa
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from lostmotion.errors import FileAccessError
from lostmotion.files.writer import PRIVATE, write_folder

BITS = 3072  # RSA: 128 bits of strength; both policies take 2048 to 4096
YEARS = 5  # of our certificate; a new one has to be trusted by each server again
EARLIER = timedelta(hours=1)  # clocks of a plant differ
CERTIFICATE, KEY = "certificate.der", "key.pem"
DAMAGED = (  # what reading a certificate of others may end in, at once or when a part of it is asked for
    ValueError,
    UnsupportedAlgorithm,
    x509.InvalidVersion,
    x509.DuplicateExtension,
    x509.UnsupportedGeneralNameType,
)


@dataclass(frozen=True)
class OwnCertificate:
    """Certificate and key by which servers know this application.

    Attributes
    ----------
    certificate, key : Path
        DER, and PEM without a password that nobody else can read.
    uri : str
        Application URI in the certificate; the link announces the same.
    until : datetime
        UTC
    """

    certificate: Path
    key: Path
    uri: str
    until: datetime

    @property
    def fingerprint(self) -> str:
        """What a person compares where the server is told to trust us."""
        return fingerprint(read_certificate(self.certificate))


def default_pki() -> Path:
    """Folder of certificates of this user: ``$XDG_CONFIG_HOME/lostmotion/pki``, else under ``~/.config``."""
    above = os.environ.get("XDG_CONFIG_HOME", "")
    return (Path(above) if Path(above).is_absolute() else Path.home() / ".config") / "lostmotion" / "pki"


def own_certificate(pki: Path) -> OwnCertificate:
    """Our certificate in ``pki/own``; it is made, with its key, where neither is there.

    Raises
    ------
    FileAccessError
        One of the two is missing, unreadable, of another key, expired, or the key can be read by others.
    """
    folder = pki / "own"
    if not folder.exists():
        write_folder(folder, _made(), mode=PRIVATE)
    path, key = folder / CERTIFICATE, folder / KEY
    certificate = read_certificate(path)
    refuse_public(key)
    if _public(read_key(key)) != _public(certificate):
        raise FileAccessError(f"expected the key of {path}, got another in {key}; {_again(folder)}")
    until = certificate.not_valid_after_utc
    if until < datetime.now(UTC):
        raise FileAccessError(f"expected a certificate that has not expired, got {until:%Y-%m-%d}; {_again(folder)}")
    names = uris(certificate)
    if not names:
        raise FileAccessError(f"expected an application URI in {path}, got none; {_again(folder)}")
    return OwnCertificate(path, key, names[0], until)


def refuse_public(path: Path) -> None:
    """Refuse a file with a secret that is not a file, or that others can read or change.

    Raises
    ------
    FileAccessError
        With the command that mends it.
    """
    try:
        found = path.stat()
    except OSError as error:
        raise FileAccessError(f"expected a readable file {path}, got {error.strerror}; check the path") from error
    if not stat.S_ISREG(found.st_mode):
        raise FileAccessError(f"expected a file, got {path}, which is none; give a file")
    if sys.platform != "win32" and (found.st_mode & 0o077 or found.st_uid not in (0, os.geteuid())):
        mode = f"mode {stat.S_IMODE(found.st_mode):04o} of user {found.st_uid}"
        raise FileAccessError(f"expected {path} for its owner alone, got {mode}; chown it to you and chmod 600 it")


def read_certificate(path: Path) -> x509.Certificate:
    """Certificate of a DER or PEM file.

    Raises
    ------
    FileAccessError
        It cannot be read, or is none.
    """
    try:
        data = path.read_bytes()
        pem = data.lstrip().startswith(b"-----")
        return x509.load_pem_x509_certificate(data) if pem else x509.load_der_x509_certificate(data)
    except OSError as error:
        raise FileAccessError(f"expected a certificate {path}, got {error.strerror}; check the path") from error
    except DAMAGED as error:
        raise FileAccessError(f"expected a certificate (DER or PEM), got something else in {path}; check it") from error


def read_key(path: Path) -> rsa.RSAPrivateKey:
    """Key of a PEM file; its bytes are in no message.

    Raises
    ------
    FileAccessError
        It cannot be read, or is no RSA key, or has a password.
    """
    key = None
    try:
        with suppress(ValueError, TypeError, UnsupportedAlgorithm):
            key = serialization.load_pem_private_key(path.read_bytes(), None)
    except OSError as error:
        raise FileAccessError(f"expected a key {path}, got {error.strerror}; check the path") from error
    if not isinstance(key, rsa.RSAPrivateKey):
        raise FileAccessError(f"expected an RSA key without password (PEM), got something else in {path}; replace it")
    return key


def fingerprint(certificate: x509.Certificate) -> str:
    """SHA-256 of a certificate as 64 hexadecimal digits in groups of four, as people compare it."""
    digits = certificate.fingerprint(hashes.SHA256()).hex().upper()
    return " ".join(digits[at : at + 4] for at in range(0, len(digits), 4))


def bare(written: str) -> str:
    """Fingerprint without what people put between its digits.

    Examples
    --------
    >>> bare("SHA256 ab:CD-ef 01")
    'ABCDEF01'
    """
    digits = written.upper().removeprefix("SHA256").removeprefix("SHA-256")
    return "".join(sign for sign in digits if sign not in " :-=")


def uris(certificate: x509.Certificate) -> list[str]:
    """Application URIs in a certificate; one at most where it is as it should be."""
    return _alternative(certificate, x509.UniformResourceIdentifier)


def hosts(certificate: x509.Certificate) -> list[str]:
    """Names and addresses of hosts in a certificate."""
    return _alternative(certificate, x509.DNSName) + _alternative(certificate, x509.IPAddress)


def _alternative(certificate: x509.Certificate, kind: type[x509.GeneralName]) -> list[str]:
    with suppress(x509.ExtensionNotFound, *DAMAGED):
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        return [str(name.value) for name in names if isinstance(name, kind)]
    return []


def _made() -> dict[str, bytes]:
    """Files of a new certificate: RSA, signed by itself, with the extensions of OPC 10000-6, 6.2.2."""
    key = rsa.generate_private_key(public_exponent=65537, key_size=BITS)
    host = platform.node()
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, f"lostmotion at {host}"[:64])])
    now = datetime.now(UTC)
    built = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - EARLIER)
        .not_valid_after(now + timedelta(days=365 * YEARS))
        .add_extension(x509.SubjectAlternativeName(_our_names(host)), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_usage(), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.CLIENT_AUTH]), critical=False)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(key.public_key()), critical=False)
    )
    signed = built.sign(key, hashes.SHA256())
    plain = serialization.NoEncryption()
    return {
        CERTIFICATE: signed.public_bytes(serialization.Encoding.DER),
        KEY: key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, plain),
    }


def _our_names(host: str) -> list[x509.GeneralName]:
    uri: x509.GeneralName = x509.UniformResourceIdentifier(f"urn:{host}:lostmotion:live")
    with suppress(ValueError):
        return [uri, x509.IPAddress(ipaddress.ip_address(host))]
    return [uri, x509.DNSName(host)]


def _usage() -> x509.KeyUsage:
    """A certificate signed by itself may sign certificates: itself."""
    return x509.KeyUsage(
        digital_signature=True,
        content_commitment=True,
        key_encipherment=True,
        data_encipherment=True,
        key_agreement=False,
        key_cert_sign=True,
        crl_sign=False,
        encipher_only=False,
        decipher_only=False,
    )


def _public(holder: x509.Certificate | rsa.RSAPrivateKey) -> bytes:
    form = serialization.PublicFormat.SubjectPublicKeyInfo
    return holder.public_key().public_bytes(serialization.Encoding.DER, form)


def _again(folder: Path) -> str:
    return f"move {folder} away: a new pair is made, which the servers have to trust"
