"""Packing models of the literature: porosity of a mixture of size classes from the porosities of its classes.

A model is a pure function of sizes, volume fractions and one-class porosities of the classes, in any order. Sizes enter
by their ratios only, so any unit of length is correct. The arrays of the linear, linear-mixture and compressible models
broadcast: leading axes are predictions, the last axis is the classes. The model of rods takes one mixture and one
number, the one-class porosity of all its classes.

The equations were read in public source code that implements the publications named here, not in the publications.

    linear.py           linear packing model (Stovall; Yu and Standish; Yu, Zou and Standish)
    linear_mixture.py   linear-mixture packing model (Yu and Standish 1991)
    compressible.py     compressible packing model (de Larrard 1999)
    rods.py             rods on a line (Farr and Groot 2009)
    empirical.py        river predictors that take a sieve curve alone
    curves.py           from a SieveCurve to size classes; statistics of a curve
    classes.py          checks, size ratios, and the sum that linear and compressible models share
"""
