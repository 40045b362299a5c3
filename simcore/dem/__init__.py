"""The discrete element core: it knows no file and no config."""
