"""Cost of the code: CPU time over sizes and ranks, and beside other programs."""
