"""Supervised blocks for the tests: every kind, with limits and counts in which every answer is in play."""

from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.export.source import Source
from tests.support.exports import block

COUNTS = {"timeout": 8, "show_scans": 2, "accept_scans": 20, "least_scans": 3, "block_key": 1234}


def supervised(kind, **settings):
    return SupervisedBlock.of(block(kind), **{**COUNTS, **settings})


def source(kind, real="lreal", **header):
    return Source(supervised(kind), "FY_101", "2026-01-31", real, **header)
