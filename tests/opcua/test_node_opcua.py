"""Links to a server that is not ours: node-opcua. Security first, then what a source needs of it."""

import asyncio
import datetime as dt

import pytest

pytest.importorskip("asyncua")


from lostmotion.live.opcua import client as client_module
from lostmotion.live.opcua.certificates import own_certificate, read_certificate
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.introduction import introduced
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.opcua.secrets import Secret, User
from lostmotion.live.opcua.security import Identity
from lostmotion.live.opcua.trust import TrustStore
from tests.opcua.certificates import URI, pair
from tests.opcua.node_server import NodeServer, config

pytestmark = pytest.mark.long

PASSWORD = "correct horse battery"  # searched for in all that is shown
READER = User("reader", Secret(PASSWORD))
BOTH = ["Basic256Sha256", "Aes256_Sha256_RsaPss"]
OP, PV = "ns=1;s=FIC101.OP", "ns=1;s=FIC101.PV"


@pytest.fixture(scope="module")
def pki(tmp_path_factory):
    """Our certificate and trust, of all that the server shows but for its identity."""
    folder = tmp_path_factory.mktemp("pki")
    own_certificate(folder)
    return folder


@pytest.fixture(scope="module")
def servers(tmp_path_factory, pki):
    """Four of them in one process, which takes 4 s of processor time."""
    folder, ours = tmp_path_factory.mktemp("node"), [str(own_certificate(pki).certificate)]
    weak = {"modes": ["None", "Sign"], "policies": ["None", BOTH[0]]}
    secure = {"clients": ours, "policies": BOTH, "users": {"reader": PASSWORD}}
    configs = {
        "plant": config(folder, pair(folder), URI, **secure),
        "expired": config(folder, pair(folder, name="expired", days=(-9, -1)), URI, **secure),
        "uri": config(folder, pair(folder, name="uri", uri="urn:somebody:else"), URI, **secure),
        "open": config(
            folder,
            pair(folder, name="open"),
            URI,
            **(secure | weak),
        ),
    }
    for name in ("server", "expired", "uri", "open"):
        TrustStore(pki).add(_certificate(folder / f"{name}.der"), "127.0.0.1")
    with NodeServer(folder, **configs) as running:
        running.do("advance", steps=30)
        yield running
    assert "horse" not in running.log.read_text()


def _certificate(path):
    return read_certificate(path)


def linked(work, address, pki, user=READER, store=None):
    """What `work` returns on a link."""

    async def story():
        client = await connected(address, Identity(pki, user), store or TrustStore(pki))
        try:
            return await work(client)
        finally:
            await client.disconnect()

    return asyncio.run(story())


async def policy_of(client):
    return client.security_policy.URI.rpartition("#")[2], client.security_policy.Mode.name


def refused(address, pki, user=READER, store=None):
    with pytest.raises(RefusedError) as told:
        linked(policy_of, address, pki, user, store)
    assert "horse" not in str(told.value)
    return told.value.reason


def test_signed_and_encrypted_with_the_best_policy(servers, pki):
    assert linked(policy_of, servers.address(), pki) == ("Aes256_Sha256_RsaPss", "SignAndEncrypt")


def test_trust_begins_with_an_introduction(servers, pki, tmp_path):
    store = TrustStore(tmp_path)
    assert refused(servers.address(), pki, store=store) == "untrusted"
    seen = asyncio.run(introduced(servers.address()))
    seen.refuse_other(str(seen).rpartition("SHA-256")[2])
    seen.believed(store)
    assert linked(policy_of, servers.address(), pki, store=store)[1] == "SignAndEncrypt"


@pytest.mark.parametrize(("name", "reason"), [("expired", "expired"), ("uri", "uri"), ("open", "policy")])
def test_a_server_that_is_wrong_is_refused(name, reason, servers, pki):
    assert refused(servers.address(name), pki) == reason


def test_a_wrong_password_and_nobody_are_refused(servers, pki):
    assert refused(servers.address(), pki, User("reader", Secret(PASSWORD + "?"))) == "user"
    assert refused(servers.address(), pki, None) == "user"


def test_a_server_that_does_not_know_us_says_so_and_we_say_what_to_do(servers, pki, tmp_path, monkeypatch):
    monkeypatch.setattr(client_module, "REQUEST", 2.0)
    store, stranger = TrustStore(pki), tmp_path / "stranger"
    with pytest.raises(RefusedError, match="have the server trust") as told:
        linked(policy_of, servers.address(), stranger, store=store)
    assert told.value.reason == "client"
    servers.do("trust", file=str(own_certificate(stranger).certificate))
    assert linked(policy_of, servers.address(), stranger, store=store)[1] == "SignAndEncrypt"


async def until(there, seconds=30):
    """Wait for what a busy machine may be late with."""
    for _ in range(10 * seconds):
        if there():
            return
        await asyncio.sleep(0.1)


def test_values_and_their_quality_arrive(servers, pki):
    """In order, with the times of their source, bad and uncertain as such.

    The sampling interval is not 0: this server then tells good values alone.
    """
    start = 1_700_000_000_000

    async def work(client):
        arrived = []

        class Handler:
            def datachange_notification(self, _node, _value, data):
                arrived.append(data.monitored_item.Value)

        subscription = await client.create_subscription(100, Handler())
        await subscription.subscribe_data_change([client.get_node(PV)], queuesize=50, sampling_interval=20)
        await until(lambda: arrived)  # the value that is there
        del arrived[:]
        for k, quality in enumerate(["Good", "Bad", "UncertainLastUsableValue", "Good"]):
            await asyncio.to_thread(servers.do, "put", tag="PV", value=float(k), at=start + 100 * k, quality=quality)
            await until(lambda k=k: len(arrived) > k)
        await subscription.delete()
        return arrived

    arrived = linked(work, servers.address(), pki)
    assert [one.Value.Value for one in arrived if one.StatusCode.is_good()] == [0.0, 3.0]
    assert [one.StatusCode.name for one in arrived] == ["Good", "Bad", "UncertainLastUsableValue", "Good"]
    stamps = [one.SourceTimestamp.replace(tzinfo=dt.UTC).timestamp() for one in arrived]
    assert stamps == pytest.approx([(start + 100 * k) / 1000 for k in range(4)], abs=1e-3)


def test_history_is_read(servers, pki):
    rows = servers.do("samples")["samples"]

    async def work(client):
        first, last = (dt.datetime.fromtimestamp(rows[k][0] / 1000, dt.UTC) for k in (0, -1))
        late = last + dt.timedelta(milliseconds=1)
        return await client.get_node(OP).read_raw_history(first, late, 1000)

    values = linked(work, servers.address(), pki)
    assert [one.Value.Value for one in values] == pytest.approx([row[1] for row in rows])
    stamps = [round(one.SourceTimestamp.replace(tzinfo=dt.UTC).timestamp() * 1000) for one in values]
    assert stamps == [row[0] for row in rows]
