"""The one place where a connection to a server is made."""

from __future__ import annotations

import asyncio
import logging
from urllib.parse import urlparse

from asyncua.client.client import Client
from asyncua.ua.status_codes import StatusCodes, get_name_and_doc
from asyncua.ua.uaerrors import UaStatusCodeError
from cryptography.exceptions import InvalidSignature

from lostmotion.addresses import without_password
from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.live.opcua.certificates import OwnCertificate
from lostmotion.live.opcua.checks import check_server, host_of, is_loopback
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.opcua.security import Identity, Offer, SecureClient, chosen, secured
from lostmotion.live.opcua.trust import TrustStore

REQUEST = 8.0  # s for the answer to one request: a busy server is not a lost one
WATCH = 5.0  # s between looks whether the server is still there, and for its answer
SILENT = (TimeoutError, ConnectionError, AssertionError)  # the last: an answer that the library does not know
NOT_THE_USER = {StatusCodes.BadUserAccessDenied, StatusCodes.BadIdentityTokenRejected}
NOT_THE_USER |= {StatusCodes.BadIdentityTokenInvalid, StatusCodes.BadUserSignatureInvalid}
NOT_US = {StatusCodes.BadCertificateUntrusted, StatusCodes.BadSecurityChecksFailed}
NOT_US |= {StatusCodes.BadCertificateInvalid, StatusCodes.BadCertificateUriInvalid}
NOT_US |= {StatusCodes.BadCertificateTimeInvalid, StatusCodes.BadCertificateUseNotAllowed}
logging.getLogger("asyncua").addHandler(
    logging.NullHandler()
)  # its warnings are not for the standard error of a command


async def connected(
    address: str, identity: Identity | None = None, trust: TrustStore | None = None, insecure: bool = False
) -> Client:
    """Client with an open session; the caller disconnects it. It does not reconnect by itself.

    Parameters
    ----------
    address : str
        ``opc.tcp://host:port/path``, without user or password. Another address that the server names is not followed.
    identity : Identity, optional
        Our certificate and user; default: the folder of this user, which is made on first use, and anonymous.
    trust : TrustStore, optional
        Which servers are believed; default: the same folder.
    insecure : bool
        Neither signed nor encrypted, as anonymous: a bench on this machine only.

    Raises
    ------
    ParameterError
        Not such an address; `insecure` off this machine or with a user.
    RefusedError
        The server is not believed, or does not believe us.
    FileAccessError
        No such server; our own certificate cannot be used.
    """
    check_address(address)
    who = identity or Identity()
    if insecure:
        return await _insecurely(address, who)
    store = trust or TrustStore(who.pki)
    offer = await offered(address)
    check_server(offer.certificate, offer.uri, address, store)
    client = SecureClient(address, timeout=REQUEST, watchdog_intervall=WATCH)
    await asyncio.to_thread(who.certificate)  # a new key takes a second
    own = await secured(client, offer, who, store, address)
    try:
        await client.connect()
    except RefusedError:
        raise
    except InvalidSignature as error:
        raise _impostor(address) from error
    except Exception as error:
        raise _told(error, address, who, own) from error
    return client


async def offered(address: str) -> Offer:
    """Endpoint to take at an address, asked in the open; nothing of it is believed yet.

    Raises
    ------
    ParameterError
        Not such an address.
    RefusedError
        There is none that signs and encrypts.
    FileAccessError
        No such server.
    """
    check_address(address)
    try:
        endpoints = await Client(address, timeout=REQUEST).connect_and_get_server_endpoints()
    except Exception as error:
        raise unreachable(address, error) from error
    return chosen(endpoints, address)


async def _insecurely(address: str, who: Identity) -> Client:
    if not on_this_machine(address):
        remedy = "connect securely: lostmotion live --trust ADDRESS is all that it takes"
        raise ParameterError.expected("--insecure with an address on this machine", without_password(address), remedy)
    if who.user is not None:
        raise ParameterError.expected("--insecure without a user", "one", "a password is not sent over an open link")
    client = Client(address, timeout=REQUEST, watchdog_intervall=WATCH)
    try:
        await client.connect()
    except Exception as error:
        raise unreachable(address, error) from error
    return client


def check_address(address: str) -> None:
    """Refuse what is no address of a server, and one with a user or a password in it.

    Raises
    ------
    ParameterError
        It does not repeat what may be a password.
    """
    parts = urlparse(address)
    if "@" in address:
        remedy = "name a file for them, and change the password: it is in the history of the shell"
        raise ParameterError.expected("an address without user and password", "one with an @", remedy)
    try:
        known = parts.scheme == "opc.tcp" and parts.hostname and parts.port != 0
    except ValueError:
        known = False
    if not known:
        raise ParameterError.expected("an address opc.tcp://host:port", repr(without_password(address)), "correct it")


def on_this_machine(address: str) -> bool:
    """Whether the host of an address is this machine.

    Examples
    --------
    >>> [on_this_machine(f"opc.tcp://{host}:4840") for host in ("localhost", "127.0.0.1", "[::1]", "plc1")]
    [True, True, True, False]
    """
    return is_loopback(host_of(address))


def unreachable(address: str, error: BaseException) -> FileAccessError:
    """Error for a server that cannot be reached or refuses, without what may be secret."""
    why = str(error) or type(error).__name__
    return FileAccessError(f"expected a server at {without_password(address)}, got {why[:200]!r}; check that it runs")


def _told(error: BaseException, address: str, who: Identity, own: OwnCertificate) -> FileAccessError:
    """Error of a server that refuses us, as far as it says why: many close the line without a word."""
    code = error.code if isinstance(error, UaStatusCodeError) else None
    if code in NOT_THE_USER:
        got = "a refusal" if who.user else "a refusal of anonymous"
        remedy = "correct user and password in their file" if who.user else "give a user: --user-file FILE"
        return RefusedError.because("user", f"{address} to take the user", got, remedy)
    if code in NOT_US or isinstance(error, SILENT):
        got = get_name_and_doc(code)[0] if code is not None else "a closed line"
        remedy = f"have the server trust {own.certificate} (SHA-256 {own.fingerprint})"
        return RefusedError.because("client", f"{address} to take our certificate", got, remedy)
    return unreachable(address, error)


def _impostor(address: str) -> RefusedError:
    got, remedy = "a wrong signature", "look for who answers in its place"
    return RefusedError.because("impostor", f"the owner of the certificate at {address}", got, remedy)
