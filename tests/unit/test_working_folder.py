"""Settings of packages that lie in the working folder."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lostmotion.working_folder import without_settings
from tests.support.places import ROOT


def test_work_is_done_elsewhere_only_where_there_is_such_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with without_settings("settings.txt"):
        assert Path.cwd() == tmp_path
    (tmp_path / "settings.txt").write_text("")
    with pytest.raises(ValueError, match="inside"), without_settings("settings.txt"):  # noqa: PT012
        assert list(Path.cwd().iterdir()) == []
        raise ValueError("inside")
    assert Path.cwd() == tmp_path


FIGURE = "import lostmotion.plot.style as style; style.new_figure()"
CONTROL = "import lostmotion as lm; lm.LinearModel((-0.5,), (1.0,), 0, 1.0).to_control()"
OWN = "import matplotlib"


@pytest.mark.parametrize(("first", "read"), [(FIGURE, False), (CONTROL, False), (OWN, True)])
def test_matplotlib_is_imported_with_the_settings_of_the_user(tmp_path, first, read):
    """What a program imports by itself is its own affair."""
    pytest.importorskip("control")
    (tmp_path / "matplotlibrc").write_text("text.usetex: True")
    words = [sys.executable, "-c", f"{first}\nimport matplotlib\nassert matplotlib.rcParams['text.usetex'] is {read}"]
    subprocess.run(words, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT / "src")}, check=True)
