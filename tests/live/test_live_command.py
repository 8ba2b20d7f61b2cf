"""What `lostmotion live` says before anything is watched."""

import asyncio

import pytest

pytest.importorskip("asyncua")

from lostmotion.cli import main
from lostmotion.live import warm
from lostmotion.live.opcua.link import Link
from lostmotion.live.opcua.refusal import RefusedError

HERE = "opc.tcp://127.0.0.1:1/plant"
LOOP = ("--op", "ns=2;s=A.OP", "--pv", "ns=2;s=A.PV", "--orders", "1,0,1", "--dt", "1", "--insecure")


def said(capsys, *words):
    """Exit code, and what stands on standard error."""
    with pytest.raises(SystemExit) as stop:
        main(["live", *map(str, words)])
    return int(stop.value.code or 0), capsys.readouterr().err


def test_a_server_that_is_not_believed_is_told_before_anything_is_compiled(monkeypatch, capsys):
    async def refuse(*_):
        raise RefusedError.because("untrusted", "a server that is believed", "another", "see --trust")

    monkeypatch.setattr("lostmotion.live.opcua.client.connected", refuse)
    monkeypatch.setattr(warm, "warm", lambda: pytest.fail("compiled before the server was met"))
    code, line = said(capsys, HERE, *LOOP)
    assert (code, line.splitlines()[-1]) == (1, "error: expected a server that is believed, got another; see --trust")


def test_a_server_that_is_not_there_is_told_and_sought():
    told = []

    async def twice():
        link = Link(_nobody, (), 1.0, lambda *what: told.append(what))
        await link.meet()
        await link.meet()

    asyncio.run(twice())
    assert told == [("lost", "", "nobody is there")]


async def _nobody():
    await asyncio.sleep(0)
    raise ConnectionError("nobody is there")


@pytest.mark.parametrize("where", ["the command line", "the plant file"])
def test_insecure_takes_no_user_file(where, tmp_path, capsys):
    if where == "the command line":
        code, line = said(capsys, HERE, *LOOP, "--user-file", tmp_path / "plc1.user")
    else:
        path = tmp_path / "plant.toml"
        loop = '[[loop]]\ntag = "A"\nop = "ns=2;s=A"\npv = "ns=2;s=B"\norders = [1, 0, 1]\ndt = 1.0\n'
        path.write_text(f'address = "{HERE}"\n[security]\nuser_file = "plc1.user"\n{loop}')
        code, line = said(capsys, path, "--insecure")
    assert code == 2
    assert line.startswith("error: expected --insecure without a user file, got ")
    assert len(line.splitlines()) == 1
