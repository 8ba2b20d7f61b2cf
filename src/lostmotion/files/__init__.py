"""Files and data frames -> LoopRecord: the only place that knows formats."""

from lostmotion.files.every_loop import read_loops
from lostmotion.files.read import read_loop
from lostmotion.files.results import read_json, write_json, write_text
from lostmotion.files.write import write_columns, write_table

__all__ = ["read_json", "read_loop", "read_loops", "write_columns", "write_json", "write_table", "write_text"]
