"""Contact of two grains found from nothing: distance and overlap of convex shapes."""
