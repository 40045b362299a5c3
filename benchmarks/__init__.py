"""Cost of a step: throughput, features, scaling, and other codes on the same bed. Run from the repository root.

throughput   one bed, one figure: python -m benchmarks.throughput
features     what each shape and each feature costs
scaling      grains from 10^3 to 10^5, one and two threads
compare      the same bed in other codes (benchmarks/others)

ellipsoid_contact   two constructions of an ellipsoid contact: depth, energy of impacts, cost of a query

beds makes and keeps the beds, measurement steps them.
"""
