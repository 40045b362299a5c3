"""Force laws of contacts, one module each; `pressing` applies them to contacts and walls."""
