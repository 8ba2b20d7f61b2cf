"""The list of files that are not run again without the compiler."""

from pathlib import Path

from tests.conftest import FILES, TESTS

MAKEFILE = Path(__file__).parents[2] / "Makefile"


def test_every_file_of_the_list_is_there():
    assert sorted(str(path.relative_to(TESTS)) for path in FILES if not path.exists()) == []


def test_no_test_of_kernels_and_estimators_is_among_them():
    assert not any(path.parent.name in ("naive", "published") or "kernel" in path.name for path in FILES)


def test_they_carry_the_marker(request):
    found = {item.path for item in request.session.items if item.get_closest_marker("processes")}
    assert found == FILES & {item.path for item in request.session.items}
    assert 'not statistics and not processes"' in MAKEFILE.read_text(encoding="utf-8")
