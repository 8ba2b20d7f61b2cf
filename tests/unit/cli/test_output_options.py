"""What a command writes is refused before the work where it could not be written after it."""

import pytest

from lostmotion.cli.output import OutputOptions
from lostmotion.errors import FileAccessError, ParameterError


class Drawn:
    def plot(self):
        from matplotlib.figure import Figure

        return Figure()


def test_what_is_known_before(tmp_path):
    (tmp_path / "keep.png").write_bytes(b"kept")
    (tmp_path / "link.json").symlink_to(tmp_path / "keep.png")
    output = OutputOptions()
    for figure in ("f.xyz", "keep", "keep.png", "keep.png/f.png"):
        with pytest.raises(FileAccessError):
            output.refuse(figures=(tmp_path / figure,))
    with pytest.raises(FileAccessError, match="link"):
        OutputOptions(force=True).refuse(tmp_path / "link.json")
    with pytest.raises(FileAccessError, match="name them apart"):
        output.refuse(tmp_path / "a", tmp_path / "b", figures=(tmp_path / "a.png", tmp_path / "a.png"))
    with pytest.raises(ParameterError, match="suffix"):
        output.refuse(table=tmp_path / "a.xlsx")
    output.refuse(None, tmp_path / "a.json", figures=(None, tmp_path / "a.png"), table=tmp_path / "a.csv")


@pytest.mark.parametrize("ending", ["png", "pdf", "svg", "PNG"])
def test_a_figure_is_whole_and_replaces_nothing(tmp_path, ending):
    path = tmp_path / f"a.{ending}"
    OutputOptions().write_figure(path, Drawn())
    before = path.read_bytes()
    assert before[:4] in (b"\x89PNG", b"%PDF", b"<?xm")
    with pytest.raises(FileAccessError, match="force=True"):
        OutputOptions().write_figure(path, Drawn())
    OutputOptions(force=True).write_figure(path, Drawn())
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
