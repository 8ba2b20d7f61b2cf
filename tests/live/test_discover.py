"""Loops of a server by the names of its nodes, and pieces of a record."""

import asyncio
from datetime import UTC, datetime

import polars as pl
import pytest

import lostmotion as lm
from lostmotion.errors import FileAccessError
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.discover import discovered
from lostmotion.live.recorder import Recorder
from lostmotion.plant import loop_list_text
from tests.support.live_server import LoopServer, node


def test_loops_are_found_by_their_names():
    async def scenario():
        async with LoopServer(["FIC101", "LIC7"]) as plant:
            client = await connected(plant.address, insecure=True)
            try:
                return await discovered(client)
            finally:
                await client.disconnect()

    found = asyncio.run(scenario())
    assert [loop.tag for loop in found] == ["FIC101", "LIC7"]
    assert (found[0].op, found[0].pv) == (node("FIC101", "OP"), node("FIC101", "PV"))
    assert (found[0].sp, found[0].mode) == (node("FIC101", "SP"), node("FIC101", "MODE"))
    assert loop_list_text(found).splitlines()[1].startswith("FIC101,ns=2;s=FIC101.OP,")


def test_pieces_are_whole_and_read_as_a_record(tmp_path):
    recorder = Recorder(tmp_path)
    assert recorder.write() is None
    begin = datetime(2026, 5, 1, tzinfo=UTC).timestamp()
    for k in range(200):
        recorder.add(begin + k, "A.OP", 0.5 * k, "Good")
        recorder.add(begin + k, "A.PV", float(k % 7), "Bad" if k == 5 else "Good")
        if k % 100 == 99:
            recorder.write()
    assert len(list(tmp_path.iterdir())) == 2
    whole = pl.concat([pl.read_parquet(piece) for piece in sorted(tmp_path.iterdir())])
    whole.write_parquet(tmp_path / "whole.parquet")
    record = lm.read_loop(tmp_path / "whole.parquet")
    assert record.dt == 1.0
    assert record.op.tolist() == [0.5 * k for k in range(200)]


def test_a_record_wants_a_folder(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FileAccessError, match="expected a folder, got the file"):
        Recorder(tmp_path / "file")
    assert len(Recorder(tmp_path / "new")) == 0, "made with the first piece"
