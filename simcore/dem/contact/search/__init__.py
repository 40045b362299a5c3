"""Searches for the contact of two convex shapes without a remembered contact: distance and overlap."""
