"""What is fetched is pinned: versions, and digests where the registry of a format lets all systems have one list."""

import json
import re

from tests.support.places import ROOT

LOCK = json.loads((ROOT / "tests" / "opcua" / "package-lock.json").read_text(encoding="utf-8"))


def test_every_package_of_npm_has_a_digest_and_no_host():
    packages = {name: one for name, one in LOCK["packages"].items() if name}
    assert len(packages) > 100
    assert [name for name, one in packages.items() if not one.get("integrity", "").startswith("sha512-")] == []
    assert "://" not in json.dumps(LOCK)


def test_the_lock_is_that_of_the_packages_asked_for():
    wanted = json.loads((ROOT / "tests" / "opcua" / "package.json").read_text(encoding="utf-8"))["dependencies"]
    assert LOCK["packages"][""]["dependencies"] == wanted
    assert {name: LOCK["packages"][f"node_modules/{name}"]["version"] for name in wanted} == wanted


def test_every_package_of_python_has_one_version():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if not re.fullmatch(r"#.*|[\w.-]+==[\w.]+", line)] == []


def test_every_package_of_python_has_the_digests_of_its_version():
    pins = [line for line in (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines() if line[0] != "#"]
    locked = [line.split() for line in (ROOT / "locked.txt").read_text(encoding="utf-8").splitlines() if line[0] != "#"]
    assert [pin for pin, *_ in locked] == pins
    assert all(re.fullmatch(r"--hash=sha256:[0-9a-f]{64}", one) for _, *digests in locked for one in digests)
    assert all(digests for _, *digests in locked)
    assert "://" not in (ROOT / "locked.txt").read_text(encoding="utf-8")
