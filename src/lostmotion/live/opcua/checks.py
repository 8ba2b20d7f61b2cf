"""What a server's certificate has to be, beside trusted (OPC 10000-4, 6.1.3): each refusal says what to do."""

from __future__ import annotations

import ipaddress
import platform
from contextlib import suppress
from datetime import UTC, datetime
from urllib.parse import urlparse

from cryptography import x509
from cryptography.hazmat.primitives.asymmetric import rsa
from cryptography.x509.oid import ExtendedKeyUsageOID

from lostmotion.live.opcua.certificates import DAMAGED, hosts, uris
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.opcua.trust import TrustStore

SHORTEST, LONGEST = 2048, 4096  # bits of RSA, of both policies
DIGESTS = ("sha256", "sha384", "sha512")
SERVER = "have its owner make a new one"


def check_server(certificate: x509.Certificate, uri: str, address: str, store: TrustStore) -> None:
    """Refuse the certificate of a server; trust comes first, as nothing else that it says is worth reading before.

    Parameters
    ----------
    certificate : Certificate
        Of the server, as it came.
    uri : str
        Application URI by which the server announces itself.
    address : str
        Where the person wanted to go.
    store : TrustStore
        Who is believed.

    Raises
    ------
    RefusedError
        See :class:`TrustStore`, :func:`check_form`; host: it is not the one of the address.
    """
    host = host_of(address)
    store.refuse_untrusted(certificate, host, address)
    check_form(certificate, uri, address)
    names = {*hosts(certificate), *store.hosts_of(certificate)}
    if not names_host(names, host):
        said = ", ".join(sorted(names)) or "no host"
        remedy = f"use one of these, or accept this one too: lostmotion live --trust {address}"
        raise RefusedError.because("host", f"a certificate for the host {host}", said, remedy)


def check_form(certificate: x509.Certificate, uri: str, address: str) -> None:
    """Refuse what nobody may trust: expired, not yet valid, of another application, too weak, for another use.

    Raises
    ------
    RefusedError
        expired, early, uri, key (one that cannot be read, too), use
    """
    try:
        _check_form(certificate, uri, address)
    except RefusedError:
        raise
    except DAMAGED as error:
        raise RefusedError.because("key", f"a certificate of {address}", "a damaged one", SERVER) from error


def _check_form(certificate: x509.Certificate, uri: str, address: str) -> None:
    now = datetime.now(UTC)
    if certificate.not_valid_after_utc < now:
        until = f"{certificate.not_valid_after_utc:%Y-%m-%d %H:%M} UTC"
        raise RefusedError.because("expired", f"a certificate of {address} in force", f"one until {until}", SERVER)
    if certificate.not_valid_before_utc > now:
        since = f"one from {certificate.not_valid_before_utc:%Y-%m-%d %H:%M} UTC"
        raise RefusedError.because("early", f"a certificate of {address} in force", since, "set the clocks of both")
    if uris(certificate) != [uri]:
        said = ", ".join(uris(certificate)) or "none"
        raise RefusedError.because("uri", f"a certificate of the application {uri}", said, SERVER)
    _check_key(certificate)
    _check_use(certificate)


def _check_key(certificate: x509.Certificate) -> None:
    key, algorithm = certificate.public_key(), certificate.signature_hash_algorithm
    bits = key.key_size if isinstance(key, rsa.RSAPublicKey) else 0
    if not SHORTEST <= bits <= LONGEST:
        said = f"{bits} bits" if bits else type(key).__name__
        raise RefusedError.because("key", f"an RSA key of {SHORTEST} to {LONGEST} bits", said, SERVER)
    if algorithm is None or algorithm.name not in DIGESTS:
        said = algorithm.name if algorithm else "none"
        raise RefusedError.because("key", "a certificate signed with SHA-256 or longer", said, SERVER)


def _check_use(certificate: x509.Certificate) -> None:
    """What is said about use must allow this one; what is not said does not forbid it."""
    with suppress(x509.ExtensionNotFound):
        use = certificate.extensions.get_extension_for_class(x509.KeyUsage).value
        if not (use.digital_signature and (use.key_encipherment or use.data_encipherment)):
            raise RefusedError.because("use", "a certificate to sign and encrypt", "another key usage", SERVER)
    with suppress(x509.ExtensionNotFound):
        uses = certificate.extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
        if not {ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.ANY_EXTENDED_KEY_USAGE} & set(uses):
            raise RefusedError.because("use", "a certificate of a server", "another extended key usage", SERVER)


def host_of(address: str) -> str:
    """Host in an address, in small letters; IPv6 without brackets."""
    return urlparse(address).hostname or ""


def names_host(names: set[str], host: str) -> bool:
    """Whether a host is among names; no wildcards, and this machine may be called by its name.

    Examples
    --------
    >>> names_host({"PLC1", "10.0.0.7"}, "plc1"), names_host({"*.plant"}, "plc1.plant"), names_host({"::1"}, "0::1")
    (True, False, True)
    """
    wanted = {_plain(host)} | ({_plain(platform.node()), "localhost"} if is_loopback(host) else set())
    return bool(wanted & {_plain(name) for name in names})


def is_loopback(host: str) -> bool:
    """Whether a host is this machine by its address or as localhost.

    Examples
    --------
    >>> [is_loopback(host) for host in ("localhost", "127.0.0.1", "::1", "plc1", "10.0.0.7")]
    [True, True, True, False, False]
    """
    with suppress(ValueError):
        return ipaddress.ip_address(host).is_loopback
    return host.lower() == "localhost"


def _plain(name: str) -> str:
    with suppress(ValueError):
        return str(ipaddress.ip_address(name))
    return name.lower().rstrip(".")
