"""Certificates of servers, right and wrong in every way that matters."""

import datetime as dt
import ipaddress
from dataclasses import dataclass
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import rsa
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

URI = "urn:lostmotion:tests:plant"
HOSTS = ("127.0.0.1", "localhost")
DAY = dt.timedelta(days=1)
KEYS: dict[tuple[str, int], rsa.RSAPrivateKey] = {}  # making one takes a while: one for each name


@dataclass(frozen=True)
class Pair:
    """Certificate and key, as objects and as files."""

    certificate: x509.Certificate
    key: rsa.RSAPrivateKey
    der: Path
    pem: Path


def key_of(name: str, bits: int = 2048) -> rsa.RSAPrivateKey:
    return KEYS.setdefault((name, bits), rsa.generate_private_key(public_exponent=65537, key_size=bits))


def pair(
    folder, name="server", uri=URI, hosts=HOSTS, days=(-1, 30), issuer=None, ca=False, bits=2048,
    use=True, extended=None,
):  # fmt: skip
    """Certificate with `uri` and `hosts`, in force from and to these days from now, signed by itself or `issuer`."""
    key, now = key_of(name, bits), dt.datetime.now(dt.UTC)
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
    names = ([x509.UniformResourceIdentifier(uri)] if uri else []) + [_host(host) for host in hosts]
    built = (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer.certificate.subject if issuer else subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now + days[0] * DAY)
        .not_valid_after(now + days[1] * DAY)
        .add_extension(x509.BasicConstraints(ca, None), critical=True)
    )
    if names:
        built = built.add_extension(x509.SubjectAlternativeName(names), critical=False)
    if use is not None:
        built = built.add_extension(_usage(use, ca), critical=True)
    kinds = [extended] if extended else [ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH]
    built = built.add_extension(x509.ExtendedKeyUsage(kinds), critical=False)
    made = built.sign(issuer.key if issuer else key, hashes.SHA256())
    return _stored(folder, name, made, key)


def revocation(issuer, *serials, days=(-1, 30)):
    """Revocation list of an authority, DER."""
    now = dt.datetime.now(dt.UTC)
    built = x509.CertificateRevocationListBuilder().issuer_name(issuer.certificate.subject)
    built = built.last_update(now + days[0] * DAY).next_update(now + days[1] * DAY)
    for serial in serials:
        one = x509.RevokedCertificateBuilder().serial_number(serial).revocation_date(now - DAY).build()
        built = built.add_revoked_certificate(one)
    return built.sign(issuer.key, hashes.SHA256()).public_bytes(serialization.Encoding.DER)


def _stored(folder, name, made, key):
    folder.mkdir(parents=True, exist_ok=True)
    der, pem = folder / f"{name}.der", folder / f"{name}.key.pem"
    der.write_bytes(made.public_bytes(serialization.Encoding.DER))
    (folder / f"{name}.crt.pem").write_bytes(made.public_bytes(serialization.Encoding.PEM))
    plain = serialization.NoEncryption()
    pem.write_bytes(key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, plain))
    pem.chmod(0o600)
    return Pair(made, key, der, pem)


def _host(host):
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _usage(use, ca):
    words = ("content_commitment", "key_encipherment", "data_encipherment", "digital_signature")
    off = dict.fromkeys(("key_agreement", "encipher_only", "decipher_only"), False)
    return x509.KeyUsage(**dict.fromkeys(words, use), key_cert_sign=True, crl_sign=ca, **off)
