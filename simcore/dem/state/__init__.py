"""The state that a step changes: bodies, contacts and walls, and the columns that a scene requires."""
