from .every_loop import read_loops
from .read import read_loop
from .results import read_json, write_json, write_text
from .write import write_columns, write_table

__all__ = ["read_json", "read_loop", "read_loops", "write_columns", "write_json", "write_table", "write_text"]
