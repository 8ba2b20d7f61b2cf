"""Changed files beside records: a plant, its loops, a store, a monitor, certificates, a form: used, or one line. The
long form is benchmarks/hostile_readers.py."""

import pytest

from tests.hostile_plant import PLANT, USES, plant_bases, plant_mutant
from tests.use_of_files import outcome

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
