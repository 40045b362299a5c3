"""Contact of two grains that remembers what the previous step found, one module for each pair of kinds."""
