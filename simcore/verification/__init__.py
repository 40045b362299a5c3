"""Error against run time of the parts of the core, each against a closed form: the datasets of `work_precision`."""
