"""One time step: candidate pairs, forces, motion."""
