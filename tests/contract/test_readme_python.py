"""The Python of the README runs as it stands there."""

import re
from pathlib import Path

import pytest

README = Path(__file__).resolve().parents[2] / "README.md"


@pytest.mark.statistics
def test_first_examples(tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    text = README.read_text(encoding="utf-8")
    start = text.index("The same from Python:")
    blocks = re.findall(r"```python\n(.*?)```", text[start:], flags=re.DOTALL)[:2]
    names = {}
    for block in blocks:
        exec(compile(block, str(README), "exec"), names)  # noqa: S102  our own
    assert names["fit"].preferred == "dead zone"
    low, high = names["fit"].interval("width")
    assert low < names["lm"].datasets.truth("TIC-201")["size"] < high
    assert (tmp_path / "fic101.png").is_file()
    assert "Dead zone" in capsys.readouterr().out
