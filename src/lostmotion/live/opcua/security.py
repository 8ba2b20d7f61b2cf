"""Signed and encrypted: which endpoint is taken, with whom, and what of the session is compared with it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from asyncua import ua
from asyncua.client.client import Client
from asyncua.crypto.security_policies import SecurityPolicyAes256Sha256RsaPss, SecurityPolicyBasic256Sha256
from asyncua.crypto.uacrypto import CertProperties
from cryptography import x509
from cryptography.hazmat.primitives.serialization import Encoding

from lostmotion.addresses import without_password
from lostmotion.live.opcua.certificates import (
    DAMAGED,
    OwnCertificate,
    default_pki,
    own_certificate,
    read_certificate,
    read_key,
)
from lostmotion.live.opcua.checks import SERVER, check_server
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.opcua.secrets import User
from lostmotion.live.opcua.trust import TrustStore

POLICIES = (SecurityPolicyAes256Sha256RsaPss, SecurityPolicyBasic256Sha256)  # the first that is offered is taken
BOTH = ua.MessageSecurityMode.SignAndEncrypt
INSECURE = (
    "INSECURE: neither signed nor encrypted, and the server can be anybody; "
    "for a bench on this machine, never for a plant."
)


@dataclass(frozen=True)
class Identity:
    """Who we are towards a server.

    Attributes
    ----------
    pki : Path
        Folder with our certificate and key, which are made on first use.
    user : User, optional
        None: anonymous.
    """

    pki: Path = field(default_factory=default_pki)
    user: User | None = None

    def certificate(self) -> OwnCertificate:
        """Our certificate; see :func:`own_certificate`."""
        return own_certificate(self.pki)


@dataclass(frozen=True)
class Offer:
    """Endpoint that was chosen, and all that it was chosen from."""

    endpoint: ua.EndpointDescription
    all: tuple[Any, ...]

    @property
    def certificate(self) -> x509.Certificate:
        """Certificate of the server, without its chain."""
        return _certificate(self.endpoint.ServerCertificate)

    @property
    def uri(self) -> str:
        """Application URI by which the server announces itself."""
        return str(self.endpoint.Server.ApplicationUri)

    @property
    def policy(self) -> Any:
        """Class of the security policy."""
        return next(policy for policy in POLICIES if self.endpoint.SecurityPolicyUri == policy.URI)


class SecureClient(Client):
    """Client of one offer: its session must be with the same server, and its password is in no log."""

    offer: Offer

    async def create_session(self) -> ua.CreateSessionResult:
        """Session; its endpoints must be those of the discovery, or the list was changed on its way.

        Raises
        ------
        RefusedError
            downgrade
        """
        result = await super().create_session()
        if _said(result.ServerEndpoints) != self.offer.all:
            raise RefusedError.because(
                "downgrade",
                "the endpoints that the server named before the session",
                "others in it",
                "look for who answers in between; if the server was just set up anew, start again",
            )
        return result

    def _add_user_auth(self, params: Any, username: str | None, password: str | None) -> None:
        """The library writes requests into its log at level DEBUG."""
        super()._add_user_auth(params, username, password)
        token = params.UserIdentityToken
        if token.Password is not None:
            token.Password = _Hidden(token.Password)


class _Hidden(bytes):
    """Bytes that are sent and not shown."""

    def __repr__(self) -> str:
        return "***"

    __str__ = __repr__


class _HiddenText(str):
    """Text that is sent and not shown, by a traceback with its local variables either."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "***"


def chosen(endpoints: Sequence[ua.EndpointDescription], address: str) -> Offer:
    """Offer with the strongest policy of those that sign and encrypt; there is no weaker one to fall back on.

    Raises
    ------
    RefusedError
        policy: the server offers none of them.
    """
    for policy in POLICIES:
        for endpoint in endpoints:
            tcp = (endpoint.EndpointUrl or "").startswith("opc.tcp://") and endpoint.ServerCertificate
            if tcp and endpoint.SecurityMode == BOTH and endpoint.SecurityPolicyUri == policy.URI:
                return Offer(endpoint, _said(endpoints))
    names = " or ".join(_short(policy.URI) for policy in POLICIES)
    offered = sorted({f"{_short(one.SecurityPolicyUri)} {one.SecurityMode.name.rstrip('_')}" for one in endpoints})
    raise RefusedError.because(
        "policy",
        f"{names} with SignAndEncrypt at {without_password(address)}",
        ", ".join(offered) or "no endpoint",
        "switch one of them on in the server",
    )


async def secured(
    client: SecureClient, offer: Offer, identity: Identity, store: TrustStore, address: str
) -> OwnCertificate:
    """Give a client the policy of an offer, our certificate, the validator and the user, before it connects."""
    own = identity.certificate()
    client.offer, client.application_uri = offer, own.uri
    client.name = client.description = "lostmotion live"
    theirs = CertProperties(offer.certificate.public_bytes(Encoding.DER), "der")
    ours, key = CertProperties(own.certificate, "der"), CertProperties(own.key, "pem")
    await client.set_security(offer.policy, ours, key, server_certificate=theirs, mode=BOTH)

    async def believe(certificate: x509.Certificate, server: ua.ApplicationDescription) -> None:
        check_server(certificate, str(server.ApplicationUri), address, store)

    client.certificate_validator = believe
    await _give_user(client, identity.user)
    return own


async def _give_user(client: Client, user: User | None) -> None:
    if user is None:
        return
    if user.password is not None:
        client.set_user(user.name)
        client.set_password(_HiddenText(user.password.reveal()))
    elif user.certificate is not None and user.key is not None:
        client.user_certificate = read_certificate(user.certificate)
        client.user_private_key = read_key(user.key)


def _said(endpoints: Iterable[ua.EndpointDescription]) -> tuple[Any, ...]:
    """What has to be the same before and in a session (OPC 10000-4, 5.7.2), sorted; the rest may be left out."""
    return tuple(sorted(_of_endpoint(one) for one in endpoints))


def _of_endpoint(one: ua.EndpointDescription) -> tuple[str, ...]:
    tokens = sorted(f"{token.PolicyId} {token.TokenType} {token.SecurityPolicyUri}" for token in one.UserIdentityTokens)
    whole = (one.EndpointUrl, one.SecurityMode, one.SecurityPolicyUri, one.SecurityLevel, one.TransportProfileUri)
    return (*(str(part) for part in whole), str(one.Server.ApplicationUri), *tokens)


def _short(uri: str | None) -> str:
    return (uri or "").rpartition("#")[2]


def _certificate(data: bytes) -> x509.Certificate:
    """First certificate of a chain; its length stands in bytes 2 and 3, as for all from 256 bytes on."""
    try:
        return x509.load_der_x509_certificate(data[: int.from_bytes(data[2:4], "big") + 4])
    except DAMAGED as error:
        raise RefusedError.because("key", "a certificate of the server", "something else", SERVER) from error
