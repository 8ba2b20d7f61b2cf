"""Structured Text with hostile comments has the same syntax tree to a parser that is not ours."""

import subprocess

import numpy as np
import pytest

from tests.plc.machine import PYTHON, ROOT, need
from tests.support.hostile_texts import MARKS, exported

TEXTS = 40


@pytest.mark.long  # a parser of the environment of the PLC
def test_the_same_tree_to_tree_sitter(tmp_path):
    need(PYTHON)
    random = np.random.default_rng(0)
    texts = ["FIC-101.csv", *("x" + "".join(random.choice(MARKS, 8)) for _ in range(TEXTS))]
    for number, text in enumerate(texts):
        (tmp_path / f"{number:02d}.st").write_text(exported("st", text)["FY_101.st"])
    files = sorted(map(str, tmp_path.iterdir()))
    command = [str(PYTHON), str(ROOT / "tests" / "plc" / "trees.py"), *files]
    digests = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    assert len(digests) == len(texts)
    assert set(digests) == {digests[0]} != {"error"}
