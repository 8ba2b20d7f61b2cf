"""Links to asyncua's own server: made with the right partner alone, and no password anywhere."""

import asyncio
import logging
import traceback
from contextlib import asynccontextmanager

import pytest

pytest.importorskip("asyncua")

from asyncua import ua

from lostmotion.cli import main
from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.live.link import LinkError
from lostmotion.live.opcua import client as client_module
from lostmotion.live.opcua.certificates import own_certificate
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.introduction import introduced
from lostmotion.live.opcua.plc_link import PlcLink
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.opcua.secrets import Secret, User
from lostmotion.live.opcua.security import Identity
from lostmotion.live.opcua.trust import TrustStore
from tests.opcua.asyncua_server import AsyncuaServer
from tests.opcua.certificates import pair

pytestmark = pytest.mark.long

PASSWORD = "correct horse battery"  # searched for in all that is shown


@pytest.fixture(scope="module")
def pki(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pki")
    own_certificate(folder)
    return folder


@pytest.fixture(scope="module")
def right(tmp_path_factory):
    """Pair of the server."""
    return pair(tmp_path_factory.mktemp("server"))


@pytest.fixture(scope="module")
def only(right):
    made = AsyncuaServer(right)
    yield made
    made.close()


@pytest.fixture
def server(only):
    """As it was at its start."""
    only.reset()
    return only


@pytest.fixture
def store(tmp_path, right):
    """Trusts the server; `TrustStore(tmp_path)` nobody."""
    made = TrustStore(tmp_path / "trust")
    made.add(right.certificate, "127.0.0.1")
    return made


@asynccontextmanager
async def link(server, pki, store, user=None):
    client = await connected(server.address, Identity(pki, user), store)
    try:
        yield client
    finally:
        await client.disconnect()


async def reading(server, pki, store, user=None):
    """Value read over a link, and its policy."""
    async with link(server, pki, store, user) as client:
        assert client.certificate_validator is not None
        policy = client.security_policy
        assert policy.Mode == ua.MessageSecurityMode.SignAndEncrypt
        return await client.get_node("ns=2;s=PV").read_value(), policy.URI.rpartition("#")[2]


def refused(server, pki, store, user=None):
    with pytest.raises(RefusedError) as told:
        asyncio.run(reading(server, pki, store, user))
    assert "\n" not in str(told.value)
    return told.value


def test_signed_and_encrypted_after_an_introduction(server, pki, tmp_path):
    store = TrustStore(tmp_path)
    assert refused(server, pki, store).reason == "untrusted"
    asyncio.run(introduced(server.address)).believed(store)
    assert asyncio.run(reading(server, pki, store)) == (1.5, "Aes256_Sha256_RsaPss")
    server.offers(("SignAndEncrypt", "Basic256Sha256"))
    assert asyncio.run(reading(server, pki, store)) == (1.5, "Basic256Sha256")


@pytest.mark.parametrize(
    ("reason", "settings"),
    [
        ("expired", {"days": (-9, -1)}),
        ("early", {"days": (1, 9)}),
        ("uri", {"uri": "urn:other"}),
        ("host", {"hosts": ("plc1",)}),
    ],
)
def test_a_certificate_that_is_trusted_and_wrong(reason, settings, server, pki, tmp_path):
    wrong, store = pair(tmp_path, **settings).certificate, TrustStore(tmp_path)
    store.add(wrong, "plc1")
    server.shows(wrong)
    assert refused(server, pki, store).reason == reason
    if reason != "host":
        with pytest.raises(RefusedError) as told:
            asyncio.run(introduced(server.address))
        assert told.value.reason == reason


def test_the_validator_is_asked_in_the_session_too(server, pki, store, monkeypatch):
    """Trust that is taken back between the endpoints and the session."""
    check, asked = client_module.check_server, []

    def once(*given):
        check(*given)
        asked.append(given)
        for path in (store.folder / "trusted").iterdir():
            path.unlink()

    monkeypatch.setattr(client_module, "check_server", once)
    assert refused(server, pki, store).reason == "untrusted"
    assert len(asked) == 1


def test_who_shows_a_trusted_certificate_without_its_key_gets_nothing(server, pki, store, tmp_path, monkeypatch):
    monkeypatch.setattr(client_module, "REQUEST", 1.0)
    other = pair(tmp_path, name="other").certificate
    store.add(other, "127.0.0.1")
    server.shows(other)
    assert refused(server, pki, store, User("reader", Secret(PASSWORD))).reason in ("client", "impostor")


@pytest.mark.parametrize("kind", ["None", "Sign"])
def test_no_weaker_endpoint_is_taken(kind, server, pki, store):
    server.offers(("None_", "None") if kind == "None" else ("Sign", "Basic256Sha256"))
    error = refused(server, pki, store)
    assert error.reason == "policy"
    assert f"{kind}; switch one of them on" in str(error)


def test_a_list_of_endpoints_that_changes_is_a_downgrade(server, pki, store, monkeypatch):
    """Somebody in between takes the best policy out of the list, which nobody has signed."""

    class Thinned(client_module.Client):
        async def connect_and_get_server_endpoints(self):
            whole = await super().connect_and_get_server_endpoints()
            return [one for one in whole if "Aes256" not in one.SecurityPolicyUri]

    monkeypatch.setattr(client_module, "Client", Thinned)
    assert refused(server, pki, store).reason == "downgrade"


@pytest.mark.parametrize("by", ["itself", "the channel alone"])
def test_no_password_is_shown_whatever_goes_wrong(by, server, pki, store, caplog, capfd):
    """All logs at level DEBUG, errors with their causes and local variables, objects, standard output and error."""
    caplog.set_level(logging.DEBUG, logger="asyncua")  # a server of another test may have hushed it
    server.users["reader"] = PASSWORD
    for token in (token for one in server.endpoints for token in one.UserIdentityTokens if by != "itself"):
        token.SecurityPolicyUri = "http://opcfoundation.org/UA/SecurityPolicy#None"
    shown = []

    async def right():
        async with link(server, pki, store, User("reader", Secret(PASSWORD))) as client:
            shown.extend([repr(client), str(client), repr(client._password), repr(vars(client))])
            return await client.get_node("ns=2;s=PV").read_value()

    assert asyncio.run(right()) == 1.5
    for user in (User("reader", Secret(PASSWORD + "?")), User("nobody", Secret(PASSWORD)), None):
        error = refused(server, pki, store, user)
        assert error.reason == "user"
        shown.extend(traceback.TracebackException.from_exception(error, capture_locals=True).format())
    logged = [record.getMessage() for record in caplog.records if not record.name.startswith("asyncua.server")]
    assert any("ActivateSessionRequest" in text for text in logged)
    for text in [*shown, *logged, *capfd.readouterr()]:
        assert "horse" not in text
    assert b"horse" not in b"".join(path.read_bytes() for path in pki.rglob("*") if path.is_file())


def test_the_link_of_a_supervisor_is_as_secure(server, pki, store, tmp_path):
    block, who = {"heartbeat": "ns=2;s=PV"}, Identity(pki)
    with PlcLink(server.address, block, who, store) as made:
        assert made.read(["heartbeat"]) == {"heartbeat": 1.5}
        with pytest.raises(LinkError, match="heartbeat"):
            made.write({"heartbeat": 2})
    with pytest.raises(RefusedError) as told:
        PlcLink(server.address, block, who, TrustStore(tmp_path / "nobody"))
    assert told.value.reason == "untrusted"
    with pytest.raises(ParameterError, match="on this machine"):
        PlcLink("opc.tcp://192.0.2.1:4840", block, who, insecure=True)


def test_insecure_is_for_a_bench_on_this_machine(server, pki):
    async def opened():
        client = await connected(server.address, Identity(pki), insecure=True)
        value = await client.get_node("ns=2;s=PV").read_value()
        await client.disconnect()
        return value

    assert asyncio.run(opened()) == 1.5
    with pytest.raises(ParameterError, match="without a user"):
        asyncio.run(connected(server.address, Identity(pki, User("reader", Secret(PASSWORD))), insecure=True))
    for elsewhere in ("opc.tcp://192.0.2.1:4840", "opc.tcp://localhost.example:4840"):
        with pytest.raises(ParameterError, match="on this machine"):
            asyncio.run(connected(elsewhere, Identity(pki), insecure=True))


@pytest.mark.parametrize(
    "address",
    [
        "opc.tcp://reader:horse@plc1",
        "opc.tcp://reader@plc1",
        "https://plc1",
        "opc.tcp://",
        "plc1",
        "opc.tcp://plc1:99999",
    ],
)
def test_an_address_is_one_and_holds_no_password(address, pki):
    with pytest.raises(ParameterError) as told:
        asyncio.run(connected(address, Identity(pki)))
    assert "horse" not in str(told.value)


def test_no_server_is_no_refusal(pki):
    with pytest.raises(FileAccessError, match="check that it runs") as told:
        asyncio.run(connected("opc.tcp://127.0.0.1:1/plant", Identity(pki)))
    assert not isinstance(told.value, RefusedError)


def told(capsys, *words):
    """Exit code of `lostmotion live` and all that it has said."""
    with pytest.raises(SystemExit) as stop:
        main(["live", *(str(word) for word in words)])
    seen = capsys.readouterr()
    assert "horse" not in seen.out + seen.err
    return int(stop.value.code or 0), seen.out, seen.err


def test_the_command_believes_a_fingerprint_and_nothing_less(server, pki, tmp_path, capsys):
    own = tmp_path / "pki" / "own"
    own.mkdir(parents=True)
    for path in (pki / "own").iterdir():
        (own / path.name).write_bytes(path.read_bytes())
        (own / path.name).chmod(0o600)
    server.users["reader"] = PASSWORD
    user = tmp_path / "user.toml"
    user.write_text(f'user = "reader"\npassword = "{PASSWORD}"\n')
    user.chmod(0o600)
    whom = (server.address, "--pki", own.parent, "--user-file", user)

    code, _, said = told(capsys, "--discover", *whom)
    assert code == 1
    assert len(said.splitlines()) == 1
    assert f"lostmotion live --trust {server.address}" in said
    code, shown, _ = told(capsys, "--trust", *whom)
    assert code == 2  # nobody is there to say yes
    digits = shown.rpartition("SHA-256")[2].strip()
    assert told(capsys, "--trust", *whom, "--fingerprint", digits[:-1] + "?")[0] == 2
    assert told(capsys, "--discover", *whom)[0] == 1
    assert told(capsys, "--trust", *whom, "--fingerprint", digits)[0] == 0
    assert told(capsys, "--discover", *whom)[0] == 0
    user.write_text(f'user = "reader"\npassword = "{PASSWORD}?"\n')
    code, _, said = told(capsys, "--discover", *whom)
    assert (code, "correct user and password" in said) == (1, True)
    user.chmod(0o644)
    assert "chmod 600" in told(capsys, "--discover", *whom)[2]


def test_the_command_says_loudly_that_a_link_is_insecure(server, pki, capsys):
    code, _, said = told(capsys, "--discover", server.address, "--pki", pki, "--insecure")
    assert code == 0
    assert said.startswith("INSECURE")
    code, _, said = told(capsys, "--discover", "opc.tcp://192.0.2.1:4840", "--pki", pki, "--insecure")
    assert (code, "on this machine" in said) == (2, True)


def test_a_plant_file_holds_no_password(tmp_path, capsys):
    loop = '[[loop]]\ntag = "a"\nop = "ns=2;s=A"\npv = "ns=2;s=B"\norders = [1, 0, 1]\ndt = 1.0\n'
    for text, code in (
        (f'address = "opc.tcp://reader:{PASSWORD}@plc1"\n', 2),
        (f'address = "opc.tcp://plc1"\npassword = "{PASSWORD}"\n', 1),
    ):
        path = tmp_path / "plant.toml"
        path.write_text(text + loop)
        assert told(capsys, path)[0] == code
