"""A supervised block in a server that is not ours (node-opcua), signed and encrypted: types, refusals, order."""

import pytest

pytest.importorskip("asyncua")

from lostmotion.compensate.request import Request
from lostmotion.compensate.supervision_variables import supervision
from lostmotion.live.link import LinkError
from lostmotion.live.opcua import plc_link
from lostmotion.live.opcua.certificates import own_certificate, read_certificate
from lostmotion.live.opcua.plc_link import PlcLink
from lostmotion.live.opcua.secrets import Secret, User
from lostmotion.live.opcua.security import Identity
from lostmotion.live.opcua.trust import TrustStore
from tests.opcua.certificates import URI, pair
from tests.opcua.node_server import NodeServer, config

pytestmark = pytest.mark.long

NAMES = [variable.name for variable in supervision("", "") if variable.section in ("input", "output")]
BUSY = 120.0  # s for an answer: anything may run beside it
WRITER = User("supervisor", Secret("correct horse battery"))
ASKED = Request(1, 500, 48_400, 4_000_000, 3).values
BLOCKS = {
    **{f"FY_{kind.upper()}": {"type": kind} for kind in ("Int16", "Int32", "UInt32", "Float", "Double", "String")},
    "FY_READONLY": {"type": "Int32", "readonly": ["CHECKSUM"]},
    "FY_REFUSED": {"type": "Int32", "refused": ["ASKED_FIRST"]},
}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The server, and what connects to it."""
    folder = tmp_path_factory.mktemp("block")
    pki = folder / "pki"
    ours = [str(own_certificate(pki).certificate)]
    blocks = {tag: {"names": NAMES, **block} for tag, block in BLOCKS.items()}
    known = config(
        folder, pair(folder), URI, clients=ours, users={"supervisor": "correct horse battery"}, blocks=blocks
    )
    TrustStore(pki).add(read_certificate(folder / "server.der"), "127.0.0.1")
    with NodeServer(folder, plant=known) as server:
        yield server, Identity(pki, WRITER), TrustStore(pki)
    assert "horse" not in server.log.read_text()


@pytest.fixture
def linked(site, monkeypatch):
    monkeypatch.setattr(plc_link, "OPENING", BUSY)
    server, identity, trust = site
    server.do("written")
    links = []

    def made(tag):
        nodes = {name.lower(): f"ns=1;s={tag}.{name}" for name in NAMES}
        links.append(PlcLink(server.address(), nodes, identity, trust, answer=BUSY))
        return links[-1]

    yield made
    for link in links:
        link.close()


def written(site):
    return site[0].do("written")["written"]


@pytest.mark.parametrize("kind", ["Int32", "UInt32", "Float", "Double"])
def test_a_request_in_the_type_of_the_node(site, linked, kind):
    tag = f"FY_{kind.upper()}"
    link = linked(tag)
    link.write(ASKED)
    assert link.read(ASKED) == ASKED
    found = written(site)
    assert {kind} == {one[1] for one in found}
    assert found[-1][0] == f"{tag}.REQUEST_ID"
    assert {one[0].partition(".")[2].lower(): one[2] for one in found} == dict(ASKED)


@pytest.mark.parametrize("kind", ["Int16", "String"])
def test_a_type_that_holds_no_request_is_refused_before_anything_is_written(site, linked, kind):
    with pytest.raises(LinkError, match="32 bits or more") as caught:
        linked(f"FY_{kind.upper()}")
    assert "heartbeat" in str(caught.value)
    assert written(site) == []


def test_a_value_without_room_for_its_sign_is_not_sent(site, linked):
    link = linked("FY_UINT32")
    with pytest.raises(LinkError, match="has no sign"):
        link.write(Request(1, 500, -400, 400, 3).values)
    assert written(site) == []
    link.write({"heartbeat": 7})
    assert written(site) == [["FY_UINT32.HEARTBEAT", "UInt32", 7]]


@pytest.mark.parametrize(("tag", "name"), [("FY_READONLY", "checksum"), ("FY_REFUSED", "asked_first")])
def test_a_write_that_is_refused_in_part_is_never_a_request(site, linked, tag, name):
    link = linked(tag)
    with pytest.raises(LinkError, match=name):
        link.write(ASKED)
    assert link.read(["request_id"]) == {"request_id": 0.0}
    assert all(one[0] != f"{tag}.REQUEST_ID" for one in written(site))


def test_what_belongs_to_the_plc_is_not_written(site, linked):
    with pytest.raises(LinkError, match="the PLC owns"):
        linked("FY_INT32").write({"accept": 1})
    assert written(site) == []
