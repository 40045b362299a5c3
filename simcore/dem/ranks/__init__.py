"""One process or many: who has which grains, and what travels between them."""
