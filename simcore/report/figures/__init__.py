"""All figures, as functions that return a matplotlib Figure; scripts save them."""
