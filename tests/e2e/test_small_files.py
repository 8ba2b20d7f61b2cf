"""Small and mixed up records through `check`: a result, or one line of error."""

import numpy as np
import pytest

from tests.support import extreme_options

CELLS = ("1", "-2.5", "1,5", "nan", "", "NaN", "1e309", "Bad", "x", "1;2", "\t", '"', "0", "1.234,5", "31.12.2026", "é")
HEADERS = ("OP", "PV", "SP", "t_s", "Time", "", "PV", "FIC1.OP", "FIC1.PV", "op [%]", "x;y")


def made(rng):
    """Text of one file: nothing, a header alone, a few rows, constant, all missing, mixed marks."""
    delimiter, end = rng.choice([",", ";", "\t", " "]), rng.choice(["\n", "\r\n", "\r"])
    width, rows = int(rng.integers(1, 5)), int(rng.choice([0, 0, 1, 2, 3, 30]))
    head = ["OP", "PV", "t_s", "SP"][:width] if rng.random() < 0.6 else list(rng.choice(HEADERS, width))
    kind = rng.integers(4)
    lines = [delimiter.join(head)] if rng.random() < 0.9 else []
    for row in range(rows):
        if kind == 0:
            cells = ["5"] * width
        elif kind == 1:
            cells = ["nan"] * width
        elif kind == 2:
            cells = [f"{row + 0.5 * k}".replace(".", str(rng.choice([".", ","]))) for k in range(width)]
        else:
            cells = list(rng.choice(CELLS, int(rng.integers(1, width + 2))))
        lines.append(str(rng.choice([delimiter, delimiter, ",", ";"])).join(cells))
    text = end.join(lines) + end * int(rng.integers(2)) if lines else ""
    return text.encode(str(rng.choice(["utf-8", "utf-8-sig", "utf-16", "latin-1"])))


@pytest.mark.parametrize("part", range(4))
def test_a_result_or_one_line(capfd, part):
    rng, bad = np.random.default_rng([65, part]), {}
    with capfd.disabled(), extreme_options.small_folder() as folder:
        for number in range(25):
            raw = made(rng)
            (folder / "f.csv").write_bytes(raw)
            for words in (["f.csv"], ["f.csv", "--dt", "1"]):
                found = extreme_options.outcome("check", words)
                if found[:3].isupper():
                    bad[number, raw[:200]] = found
    assert bad == {}
