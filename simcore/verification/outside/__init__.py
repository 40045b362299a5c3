"""Packings whose outcome others have published, or a closed form gives: cases with bands, how they are run and measured."""
