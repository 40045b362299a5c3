"""Candidate models of porosity from a sieve curve and the form of the grains.

    one_class.py   the range of one-class porosities of our beds, and the check of a porosity against it
    stretch.py     how form changes the effective size ratio
    skeletons.py   packing models of a sieve curve that give the one-class porosity for one class
    candidates.py  the candidates, their parameters, and the prediction

docs/appendices/size_and_form_plan.md states the rules by which a candidate is chosen.
"""
