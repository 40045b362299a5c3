"""Measurements, as figures and never as tests. Run from the repository root: python -m benchmarks.speed.throughput.

speed/        what the code costs: one bed, each feature, over sizes and ranks, beside other programs
correctness/  that results are right: the same bits on any ranks, exact contacts, faults that are met
studies/      measurements that constants and statements of the documentation rest on

beds makes and keeps the beds, measurement steps them.
"""
