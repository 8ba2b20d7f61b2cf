"""Hypothesis: the same examples in every CI run, new ones at the desk. What is left out of the run with the JIT off."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

from tests.support import stores

collect_ignore = ["plc/build.py", "plc/parse.py", "plc/trees.py"]  # run by the Python of .venv-plc

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("desk", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "desk")

SLOW_DOCTESTS = {
    "lostmotion.diagnose.any_record.diagnose",
    "lostmotion.diagnose.one_record.diagnose",
    "lostmotion.identify.estimate.identify",
    "lostmotion.identify.recursive.ml.RecursiveML",
}
# Processes, files and texts: nothing of what they test is compiled code, or other tests run it with the JIT off.
PROCESSES = {
    "contract": "documentation every_message pages public_names scripts sizes startup writing",
    "e2e": "audit closed_output commands_of_batches demo_live demo_plant live_store odd_words outside_tree page "
    "page_attacks page_monitors plant_shared plc_of_ones_own refused_before_work report_in_browser "
    "several_files several_loops shared_data_reads stopped_batches supervised_command supervised_machine",
    "live": "cut_network discover handed_over joined link live_command plant_file plc_link supervision_settings "
    "write_command write_faults writer",
    "opcua": "asyncua_security node_block node_opcua node_restart",
    "properties": "export_printer files hostile_files hostile_json hostile_plant loop_list missing one_answer "
    "outside_text",
    "unit": "apart audit_engines audit_history audit_limit audit_rank audit_run columns command_parts control_system "
    "database datasets dates_of_records diagnosis_figure export_files figures fit_text html light_imports "
    "live_certificates loads long_text loop_list matlab matlab_v5 missing next_steps numba_cache one_answer "
    "one_tag_a_file op_units output_options packed pages parquet_pieces plant_report plant_report_parts "
    "plant_sources read_loop record_figure run_many status_message store store_bad_input store_watches "
    "supervised_export times units web_desk web_files web_guard web_jobs web_kept web_monitor web_patience "
    "web_plant web_records web_serve web_tasks web_trend web_trend_pages wording write writer",
}
TESTS = Path(__file__).parent
FILES = {TESTS / folder / f"test_{name}.py" for folder, names in PROCESSES.items() for name in names.split()}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark them, before marked tests are deselected."""
    for item in items:
        if item.name in SLOW_DOCTESTS:
            item.add_marker(pytest.mark.statistics)
        if item.path in FILES:
            item.add_marker(pytest.mark.processes)


@pytest.fixture(scope="session")
def postgresql():
    """One server a session, ended by its own stop."""
    server = stores.started()
    yield server
    server.stop()
