"""Changed files beside records: a plant, its loops, a store, a monitor, certificates, a form: used, or one line. The
long form is benchmarks/hostile_readers.py."""

import csv
import json

import pytest

from lostmotion.errors import DataError
from lostmotion.files.schema import toml_of
from lostmotion.live.plant_file import read_plant_file
from lostmotion.plant.loop_list import parse_loop_list
from tests.support.hostile_plant import PLANT, USES, plant_bases, plant_mutant
from tests.support.use_of_files import outcome

NEEDS = {"store": "alembic", "dropped file": "python_multipart", "JSON lines": "starlette",
         "state on the page": "starlette", "certificate": "cryptography", "list of hosts": "cryptography"}  # fmt: skip
EACH = {"store": 8, "certificate": 15}


@pytest.mark.parametrize("kind", PLANT)
def test_each_is_used_or_refused_in_one_line(kind, tmp_path, capfd):
    pytest.importorskip(NEEDS.get(kind, "numpy"))
    path = tmp_path / "a.dat"
    for base in plant_bases(kind):
        path.write_bytes(base)
        assert outcome(path, USES[kind][1]) == "read"
    for number in range(EACH.get(kind, 40)):
        path.write_bytes(plant_mutant(kind, number))
        assert outcome(path, USES[kind][1]) in ("read", "refused"), number
    assert capfd.readouterr().err == ""


def test_toml_as_deep_as_a_well(tmp_path):
    for text in ("a = " + "[" * 3000, "a = " + "[" * 60 + "]" * 60, "a = {b=" * 3000):
        with pytest.raises(ValueError, match=r"deeper than 40|Invalid|Unclosed|Expected"):
            toml_of(text)
    (tmp_path / "plant.toml").write_text("a = " + "[" * 3000)
    with pytest.raises(DataError, match=r"expected TOML in plant\.toml, got deeper than 40"):
        read_plant_file(tmp_path / "plant.toml")


LINES = (
    '{"kind": "report", "time": ' + "9" * 400 + ', "width": {"value": ' + "9" * 400 + "}}",
    '{"kind": "report", "time": NaN, "width": {"value": 1.0}}', '{"kind": "start", "dt": 1e999}',
    '{"kind": "note", "message": "\\ud800"}', '{"kind": "note", "message": ' + "[" * 900 + "]" * 900 + "}",
)  # fmt: skip


@pytest.mark.parametrize("line", LINES, ids=range(len(LINES)))
def test_lines_of_a_monitor_that_no_page_could_show(line, tmp_path):
    """Once an OverflowError, JSON that is none, or text that cannot be sent."""
    pytest.importorskip("starlette")
    from lostmotion.web.monitors.monitor import Watched

    good = json.dumps({"kind": "report", "time": 1.0, "width": {"value": 2.0}})
    (tmp_path / "a.jsonl").write_text(f"{good}\n{line}\n")
    (said,) = Watched(str(tmp_path / "a.jsonl")).look()
    assert (said.lines, said.bad, said.trouble) == (2, 1, "")
    json.dumps(said.to_dict(), allow_nan=False, ensure_ascii=False).encode()


def test_loop_lists_with_a_hundred_thousand_odd_rows():
    rows = "\n".join(f"F{k},heavy" for k in range(100_000))
    with pytest.raises(DataError, match="and 99990 more lines") as caught:
        parse_loop_list(f"tag,weight\n{rows}")
    assert len(str(caught.value)) < 2000
    with pytest.raises(DataError, match="cells of text in the loop list, got field larger than"):
        parse_loop_list("tag,area\nF1," + "x" * (csv.field_size_limit() + 1))
    with pytest.raises(DataError, match="at most 1000 columns in the loop list, got 100000"):
        parse_loop_list(",".join(f"c{k}" for k in range(100_000)) + "\n1,2")
    with pytest.raises(DataError, match="a column 'tag' in") as caught:
        parse_loop_list(",".join("y" * 9999 for _ in range(1)) + ",b\n1,2")
    assert len(str(caught.value)) < 500
