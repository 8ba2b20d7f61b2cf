"""Parts of ``benchmarks/diagnosis.py``: loops with their truth, calibration, scores, the page."""
