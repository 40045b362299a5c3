"""Force laws of contacts, one module each, and pressing, which applies them to contacts and walls."""
