"""Porosity models: regression, cross-validation, prediction."""
