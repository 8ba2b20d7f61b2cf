"""Are the results of two trees the same? Fits, diagnoses, blocks and exports of real and simulated loops as JSON.

Run before a change: ``.venv/bin/python benchmarks/same_results.py record before.json``
After it:            ``.venv/bin/python benchmarks/same_results.py record after.json``
Then:                ``.venv/bin/python benchmarks/same_results.py compare before.json after.json``

``--tree FOLDER`` records another checkout with the packages of this one. ``--only PART`` of a name. Uses public names
only, so that both trees run the same script. Numbers must agree to 1e-9 relative, everything else exactly; exit code 1
where they do not.
"""

# ruff: noqa: PLC0415  the tree to import from is known when a case runs
from __future__ import annotations

import argparse
import csv
import hashlib
import json
import math
import os
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"
TOLERANCE = 1e-9
SKIPPED = {"labels.csv", "index.csv"}
TARGETS = ("st", "plcopen", "tcpou", "scl", "l5x", "c")
COLUMNS = {
    "damadics": {"op": "LC74_20CV_pct", "pv": "LC74_20X_pct", "sp": None, "op_span": (0.0, 100.0)},
    "dcmotor": {"op": "voltage", "pv": "rpm"},
    "cascaded_tanks": {"op": "uEst", "pv": "yEst"},
}


def cases() -> list[tuple[str, str]]:
    """Names of all cases, by the function that makes them."""
    files = [("file", str(path.relative_to(DATA))) for path in sorted(DATA.glob("*/*.csv")) if path.name not in SKIPPED]
    loops = [("loop", f"{seed} {rough}") for seed in range(20) for rough in ("smooth", "rough")]
    tanks = [("tank", f"{seed} {kind}") for seed in range(3) for kind in ("dead zone", "backlash", "stiction", "none")]
    return files + loops + tanks + [("recursive", str(seed)) for seed in range(3)]


def run(case: tuple[str, str]) -> tuple[str, Any]:
    """One case: name and result as plain JSON."""
    how, what = case
    try:
        result = {"file": of_file, "loop": of_loop, "tank": of_tank, "recursive": of_recursive}[how](what)
    except Exception as error:  # noqa: BLE001  what is raised is a result here
        result = {"raised": f"{type(error).__name__}: {error}".replace(str(DATA), "DATA")}
    return f"{how} {what}", json.loads(json.dumps(result, default=str))


def of_file(what: str) -> dict[str, Any]:
    """A real record: read, checked, identified as a dead zone, diagnosed."""
    import lostmotion as lm

    options = dict(COLUMNS.get(what.split("/", maxsplit=1)[0], {}))
    try:
        record = lm.read_loop(DATA / what, **options)
    except lm.InputError as error:
        refused = str(error).replace(str(DATA), "DATA")
        with (DATA / what).open(encoding="utf-8-sig") as stream:
            if "OP" not in next(csv.reader(stream)):
                return {"refused": refused}
        return {"refused": refused, **of_record(lm.read_loop(DATA / what, dt=10.0, time=False))}
    return of_record(record)


def of_record(record: Any) -> dict[str, Any]:
    """What the commands would say of a record."""
    import lostmotion as lm

    result: dict[str, Any] = {"check": lm.check(record).summary()}
    for name, work in (("identify", lm.identify), ("diagnose", lm.diagnose)):
        try:
            found = work(record)
        except lm.InputError as error:
            result[name] = f"refused: {error}"
            continue
        result[name] = {"said": found.summary(), **found.to_dict()}
        fit = found if name == "identify" else found.fit
        result[name]["block"] = of_block(fit)
    return result


def of_block(fit: Any) -> Any:
    """Block of a fit and its exports as digests."""
    import lostmotion as lm
    from lostmotion.export import export

    try:
        block = fit.block(span=(float(fit.data.u.min()), float(fit.data.u.max())))
    except lm.InputError as error:
        return f"refused: {error}"
    files = {}
    for target in TARGETS:
        done = export(block, target, name="FY_101", date="2026-01-31")
        files.update({f"{target} {name}": digest(text) for name, text in done.files.items()})
    return {"block": block.to_dict(), "files": files}


def digest(text: str) -> str:
    """Short fingerprint of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def of_loop(what: str) -> dict[str, Any]:
    """A random faulty loop."""
    import lostmotion as lm
    from lostmotion.evaluate import random_faulty_loop

    seed, rough = what.split()
    loop = random_faulty_loop(100 + int(seed), samples=1200, rough=rough == "rough")
    return of_record(lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0))


def of_tank(what: str) -> dict[str, Any]:
    """An explicit kind on the paper's tank in open loop, with known gain and orders, and all automatic."""
    import numpy as np

    import lostmotion as lm

    seed, kind = what.split(maxsplit=1)
    tank = lm.platforms.level_tank()
    valve = {"backlash": lm.Backlash(1.5), "stiction": lm.Stiction(1.5, 0.6), "none": lm.Identity()}.get(kind)
    model = tank if valve is None else lm.Hammerstein(valve, tank.linear)
    u = lm.signals.prs(1500, -5, 5, hold=10, seed=int(seed))
    y = model.simulate(u) + np.random.default_rng(int(seed)).normal(scale=0.1, size=u.size)
    told = lm.identify(u, y, dt=0.1, nonlinearity=kind, orders=(3, 2, 3), noise="white", gain=tank.linear.gain)
    free = lm.identify(u, y, dt=0.1, nonlinearity=kind)
    result = {"told": told.to_dict(), "free": free.to_dict(), "block": of_block(free)}
    if kind == "dead zone":
        study = lm.compensation_study(
            free, lm.PI(0.4, 0.1), sp_step=1.0, span=(-10, 10), op_now=0.0, samples=600, runs=2, draws=3
        )
        result["study"] = study.to_dict()
        result["design"] = lm.design(free, op_limits=(-5, 5), duration=60).to_dict()
    return result


def of_recursive(what: str) -> dict[str, Any]:
    """Both recursive estimators in one run and through their bytes."""
    import numpy as np

    import lostmotion as lm

    tank = lm.platforms.level_tank()
    u = lm.signals.prs(6000, -5, 5, hold=10, seed=int(what))
    y = tank.simulate(u) + np.random.default_rng(int(what)).normal(scale=0.1, size=u.size)
    result = {}
    for kind in (lm.RecursiveIV, lm.RecursiveML):
        est = kind(na=3, nb=2, delay=3, gain=tank.linear.gain)
        est.run(u[:3000], y[:3000])
        again = kind.from_bytes(est.to_bytes())
        for row in range(3000, 3500):
            missing = row == 3200 and kind is lm.RecursiveML
            again.update(u[row], np.nan if missing else y[row])
        path = again.run(u[3500:], y[3500:])
        estimate = again.estimate
        result[kind.__name__] = {
            "parameters": dict(estimate.parameters),
            "errors": dict(estimate.standard_errors),
            "status": estimate.status.name,
            "path": {name: np.asarray(value)[::500].tolist() for name, value in path.values.items()},
        }
    return result


def record(out: Path, tree: Path, only: str) -> None:
    """Run all cases on all cores and write them."""
    os.environ["PYTHONPATH"] = str(tree / "src")
    sys.path.insert(0, str(tree / "src"))
    chosen = [case for case in cases() if only in " ".join(case)]
    found = {}
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for done, (name, result) in enumerate(pool.map(run, chosen), 1):
            found[name] = result
            print(f"[{done}/{len(chosen)}] {name}", file=sys.stderr, flush=True)
    with tempfile.NamedTemporaryFile("w", dir=out.parent, delete=False, encoding="utf-8") as stream:
        json.dump(found, stream, indent=0)
    Path(stream.name).replace(out)


def differences(one: Any, other: Any, at: str = "") -> list[str]:
    """Where two results differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        missing = [f"{at}/{key}: only in one" for key in one.keys() ^ other.keys()]
        return missing + [
            line for key in one.keys() & other.keys() for line in differences(one[key], other[key], f"{at}/{key}")
        ]
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        return [line for i, pair in enumerate(zip(one, other, strict=True)) for line in differences(*pair, f"{at}/{i}")]
    if isinstance(one, float | int) and isinstance(other, float | int) and not isinstance(one, bool):
        close = math.isclose(one, other, rel_tol=TOLERANCE, abs_tol=1e-300)
        return [] if close else [f"{at}: {one!r} and {other!r}"]
    return [] if one == other else [f"{at}: {str(one)[:300]!r} and {str(other)[:300]!r}"]


def compare(before: Path, after: Path) -> int:
    """Print what differs; exit code."""
    one, other = (json.loads(path.read_text(encoding="utf-8")) for path in (before, after))
    lines = differences(one, other)
    for line in lines[:200]:
        print(line)
    changed = {line.split("/")[1] for line in lines}
    print(f"{len(one)} cases, {len(changed)} of them differ, in {len(lines)} places")
    return 1 if lines else 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    recording = commands.add_parser("record")
    recording.add_argument("out", type=Path)
    recording.add_argument("--tree", type=Path, default=ROOT)
    recording.add_argument("--only", default="")
    comparing = commands.add_parser("compare")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    arguments = parser.parse_args()
    if arguments.command == "record":
        record(arguments.out.resolve(), arguments.tree.resolve(), arguments.only)
    else:
        sys.exit(compare(arguments.before, arguments.after))


if __name__ == "__main__":
    main()
