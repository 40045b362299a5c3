"""The discrete element core, which is independent of files and of the configuration."""
