"""Candidate models of porosity from a sieve curve and the form of the grains.

    one_class.py   one-class porosity from form statistics, of all grains or by class
    stretch.py     how form changes the effective size ratio
    skeletons.py   packing models of a sieve curve that give the one-class porosity for one class
    candidates.py  the candidates, their parameters, and the prediction

docs/appendices/size_and_form_plan.md states the rules by which a candidate is chosen.
"""
