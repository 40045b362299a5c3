"""The time step: candidate pairs, contacts, forces and motion."""
