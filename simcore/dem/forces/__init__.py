"""Force laws of contacts, one module each."""
