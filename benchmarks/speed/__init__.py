"""What the code costs: CPU time, beside other programs, over sizes and ranks."""
