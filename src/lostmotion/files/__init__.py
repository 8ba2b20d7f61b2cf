"""Files and data frames -> LoopRecord: the only place that knows formats."""
