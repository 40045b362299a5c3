"""Which code, which machine and how much CPU time a result comes from."""
