"""Measurements, not tests. Run them from the repository root: python -m benchmarks.speed.throughput.

    speed/        cost of the code: one bed, each feature, over sizes and ranks, beside other programs
    correctness/  checks of results: the same bits on any ranks, exact contacts, behaviour after faults
    studies/      measurements behind constants and statements of the documentation

The module `beds` makes and stores the beds, and `measurement` measures steps in them.
"""
