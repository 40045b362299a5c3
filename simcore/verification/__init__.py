"""Error and run time of the parts of the core, measured against references: the datasets of `work_precision`."""
