"""Many packings: studies, their cost, their tables and the committed rows."""
