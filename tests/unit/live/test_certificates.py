"""Which certificates are believed, what of ours is on the disk, and that secrets are not shown."""

import copy
import os
import pickle
import stat
from types import SimpleNamespace

import pytest

pytest.importorskip("asyncua")

from cryptography.x509.oid import ExtendedKeyUsageOID

from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.live.opcua import checks, secrets
from lostmotion.live.opcua.certificates import bare, default_pki, fingerprint, hosts, own_certificate, uris
from lostmotion.live.opcua.checks import check_server
from lostmotion.live.opcua.introduction import Introduction
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.opcua.trust import TrustStore
from tests.opcua.certificates import URI, pair, revocation

ADDRESS = "opc.tcp://127.0.0.1:4840/plant"
posix = pytest.mark.skipif(os.name != "posix", reason="modes of POSIX")


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """Made once: a key of 3072 bits takes half a second."""
    return own_certificate(tmp_path_factory.mktemp("pki"))


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


@posix
def test_own_pair_is_made_once_for_its_owner_alone(own):
    pki = own.certificate.parents[1]
    assert own_certificate(pki) == own
    assert mode(own.key) == 0o600
    assert sorted(path.name for path in pki.rglob("*")) == ["certificate.der", "key.pem", "own"]
    from lostmotion.live.opcua.certificates import read_certificate, read_key

    certificate = read_certificate(own.certificate)
    assert uris(certificate) == [own.uri]
    assert hosts(certificate)
    assert read_key(own.key).key_size == 3072
    assert certificate.signature_hash_algorithm.name == "sha256"
    assert own.fingerprint.split() == [bare(own.fingerprint)[at : at + 4] for at in range(0, 64, 4)]


@posix
def test_own_pair_that_cannot_be_used_is_refused(own, tmp_path):
    folder = tmp_path / "own"
    folder.mkdir()
    path, key = folder / own.certificate.name, folder / own.key.name
    with pytest.raises(FileAccessError, match=r"expected a certificate .* check the path"):
        own_certificate(tmp_path)
    path.write_bytes(own.certificate.read_bytes())
    with pytest.raises(FileAccessError, match=r"key\.pem, got No such file"):
        own_certificate(tmp_path)
    key.write_bytes(own.key.read_bytes())
    key.chmod(0o640)
    with pytest.raises(FileAccessError, match=r"mode 0640 .* chmod 600"):
        own_certificate(tmp_path)
    key.write_bytes(pair(tmp_path / "other").pem.read_bytes())
    key.chmod(0o600)
    with pytest.raises(FileAccessError, match=r"got another in .* move"):
        own_certificate(tmp_path)
    key.write_bytes(b"-----BEGIN PRIVATE KEY-----\nc2VjcmV0\n")
    with pytest.raises(FileAccessError, match="RSA key without password") as told:
        own_certificate(tmp_path)
    assert "c2VjcmV0" not in str(told.value)
    old = pair(tmp_path / "old", days=(-9, -1))
    path.write_bytes(old.der.read_bytes())
    key.write_bytes(old.pem.read_bytes())
    with pytest.raises(FileAccessError, match="has not expired"):
        own_certificate(tmp_path)


def test_default_folder_is_that_of_the_user(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert default_pki() == tmp_path / "lostmotion" / "pki"
    monkeypatch.setenv("XDG_CONFIG_HOME", "not/absolute")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert default_pki() == tmp_path / "home" / ".config" / "lostmotion" / "pki"


WRONG = {
    "expired": ({"days": (-9, -1)}, "in force, got one until"),
    "early": ({"days": (1, 9)}, "set the clocks"),
    "uri": ({"uri": "urn:somebody:else"}, "urn:somebody:else"),
    "uri of none": ({"uri": None}, "got none"),
    "key": ({"bits": 1024}, "1024 bits"),
    "use": ({"use": False}, "another key usage"),
    "use of a client": ({"extended": ExtendedKeyUsageOID.CLIENT_AUTH}, "certificate of a server"),
    "host": ({"hosts": ("plc1", "10.0.0.7")}, "127.0.0.1, got 10.0.0.7, plc1; use one of these"),
}


@pytest.mark.parametrize("fault", WRONG)
def test_a_trusted_certificate_that_is_wrong_is_refused(fault, tmp_path):
    settings, said = WRONG[fault]
    wrong = pair(tmp_path, name=fault, **settings).certificate
    store = TrustStore(tmp_path / "pki")
    store.add(wrong, "plc1")
    with pytest.raises(RefusedError, match=said) as told:
        check_server(wrong, URI, ADDRESS, store)
    assert told.value.reason == fault.split()[0]
    assert "\n" not in str(told.value)


def test_a_weak_digest_is_refused(tmp_path):
    """No library at hand signs with SHA-1 any more."""
    key = pair(tmp_path).certificate.public_key()
    for algorithm in (SimpleNamespace(name="sha1"), None):
        shown = SimpleNamespace(public_key=lambda: key, signature_hash_algorithm=algorithm)
        with pytest.raises(RefusedError, match="SHA-256 or longer"):
            checks._check_key(shown)


def test_trust_is_given_by_certificate_and_taken_back(tmp_path):
    store, one, other = TrustStore(tmp_path / "pki"), pair(tmp_path).certificate, pair(tmp_path).certificate
    with pytest.raises(RefusedError, match=r"compare this .* --trust opc.tcp://127.0.0.1") as told:
        check_server(one, URI, ADDRESS, store)
    assert told.value.reason == "untrusted"
    assert fingerprint(one) in str(told.value)
    path = store.add(one, "127.0.0.1")
    check_server(one, URI, ADDRESS, store)
    with pytest.raises(RefusedError, match="ask who changed it") as told:  # the same key, the same names, made anew
        check_server(other, URI, ADDRESS, store)
    assert told.value.reason == "changed"
    path.unlink()
    with pytest.raises(RefusedError):
        check_server(one, URI, ADDRESS, store)


def test_a_host_that_a_person_accepted_counts_for_that_certificate_alone(tmp_path):
    store = TrustStore(tmp_path / "pki")
    named, other = (pair(tmp_path, name=name, hosts=("plc1",)).certificate for name in ("a", "b"))
    store.add(named, "127.0.0.1")
    check_server(named, URI, ADDRESS, store)
    check_server(named, URI, "opc.tcp://PLC1:4840", store)
    with pytest.raises(RefusedError) as told:
        check_server(named, URI, "opc.tcp://10.0.0.7:4840", store)
    assert told.value.reason == "host"
    store.add(other, "plc1")
    with pytest.raises(RefusedError) as told:
        check_server(other, URI, ADDRESS, store)
    assert told.value.reason == "host"


def test_an_authority_is_believed_with_its_revocation_list(tmp_path):
    authority = pair(tmp_path, name="authority", ca=True, uri=None, hosts=())
    good, bad = (pair(tmp_path, name=name, issuer=authority).certificate for name in ("good", "bad"))
    pki = tmp_path / "pki"
    store = TrustStore(pki)
    for folder in ("authorities", "crl", "trusted"):
        (pki / folder).mkdir(parents=True)
    (pki / "trusted" / "authority.der").write_bytes(authority.der.read_bytes())
    with pytest.raises(RefusedError) as told:  # who is trusted as a server vouches for nobody
        check_server(good, URI, ADDRESS, store)
    assert told.value.reason == "untrusted"
    (pki / "authorities" / "authority.pem").write_bytes(authority.der.with_suffix(".crt.pem").read_bytes())
    with pytest.raises(RefusedError, match="put it into") as told:
        check_server(good, URI, ADDRESS, store)
    assert told.value.reason == "unlisted"
    (pki / "crl" / "a.crl").write_bytes(revocation(authority, bad.serial_number))
    check_server(good, URI, ADDRESS, store)
    with pytest.raises(RefusedError) as told:
        check_server(bad, URI, ADDRESS, store)
    assert told.value.reason == "revoked"
    (pki / "crl" / "a.crl").write_bytes(revocation(authority, days=(-9, -1)))
    with pytest.raises(RefusedError) as told:
        check_server(good, URI, ADDRESS, store)
    assert told.value.reason == "unlisted"
    leaf = pair(tmp_path, name="leaf")
    (pki / "authorities" / "leaf.der").write_bytes(leaf.der.read_bytes())
    forged = pair(tmp_path, name="forged", issuer=leaf).certificate
    with pytest.raises(RefusedError) as told:  # no authority, whatever folder it lies in
        check_server(forged, URI, ADDRESS, store)
    assert told.value.reason == "untrusted"
    (pki / "authorities" / "junk.der").write_bytes(b"junk")
    with pytest.raises(FileAccessError, match=r"junk.der"):
        check_server(forged, URI, ADDRESS, store)


def test_an_introduction_shows_what_to_compare_and_takes_the_whole_fingerprint(tmp_path):
    shown = Introduction(ADDRESS, pair(tmp_path, hosts=("plc1",)).certificate)
    digits = fingerprint(shown.certificate)
    assert digits in str(shown)
    assert "does not name 127.0.0.1" in str(shown)
    for same in (digits, digits.lower(), bare(digits), f"SHA256:{digits.replace(' ', ':')}"):
        shown.refuse_other(same)
    with pytest.raises(ParameterError, match="64 digits"):
        shown.refuse_other(digits[:20])
    with pytest.raises(RefusedError, match="who answers"):
        shown.refuse_other("0" * 64)


def test_a_certificate_with_colours_is_shown_without_them(tmp_path):
    shown = Introduction(ADDRESS, pair(tmp_path, name="a\x1b[2J\nb").certificate)
    assert "\x1b" not in str(shown)
    assert len(str(shown).splitlines()) == 6


PASSWORD = "correct horse"  # searched for in all that is shown


def test_a_secret_is_not_shown_or_stored():
    user = secrets.User("reader", secrets.Secret(PASSWORD))
    for shown in (repr(user), str(user), f"{user.password}", f"{user.password!r}", "%s" % user.password):  # noqa: UP031
        assert "horse" not in shown
    for store in (pickle.dumps, copy.deepcopy):
        with pytest.raises(TypeError, match="not stored"):
            store(user)
    assert not hasattr(user.password, "__dict__")
    assert user.password.reveal() == PASSWORD


@posix
def test_a_user_comes_from_a_private_file(tmp_path):
    path = tmp_path / "user.toml"
    path.write_text(f'user = "reader"\npassword = "{PASSWORD}"\n')
    path.chmod(0o644)
    with pytest.raises(FileAccessError, match="chmod 600"):
        secrets.user_from(path)
    path.chmod(0o600)
    assert secrets.user_from(path).password.reveal() == PASSWORD
    keys = pair(tmp_path, name="person")
    for text in (
        f'user = "reader"\npassword = {PASSWORD}',
        f'password = "{PASSWORD}"',
        f'user = "a"\npassword = "{PASSWORD}"\nmore = 1',
        f"\xff{PASSWORD}",
        f'user = ""\npassword = "{PASSWORD}"',
    ):
        path.write_text(text, encoding="latin-1")
        with pytest.raises(ParameterError, match="TOML with") as told:
            secrets.user_from(path)
        assert "horse" not in str(told.value)
        assert told.value.__cause__ is None
    path.write_text(f'certificate = "{keys.der.name}"\nkey = "{keys.pem.name}"\n')
    assert secrets.user_from(path) == secrets.User(certificate=keys.der, key=keys.pem)
    keys.pem.chmod(0o644)
    with pytest.raises(FileAccessError, match="chmod 600"):
        secrets.user_from(path)
    with pytest.raises(FileAccessError, match="got No such file"):
        secrets.user_from(tmp_path / "none")
    with pytest.raises(FileAccessError, match="which is none"):
        secrets.user_from(tmp_path)


def test_a_user_comes_from_the_environment_whole_or_not_at_all(monkeypatch):
    monkeypatch.delenv(secrets.USER, raising=False)
    monkeypatch.delenv(secrets.PASSWORD, raising=False)
    assert secrets.user_from(None) is None
    monkeypatch.setenv(secrets.PASSWORD, PASSWORD)
    with pytest.raises(ParameterError, match="set both") as told:
        secrets.user_from(None)
    assert "horse" not in str(told.value)
    monkeypatch.setenv(secrets.USER, "reader")
    assert secrets.user_from(None).password.reveal() == PASSWORD
