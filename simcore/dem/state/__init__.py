"""What the step changes: bodies, contacts and walls, and which of their columns a scene has."""
