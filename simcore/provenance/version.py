"""The version of Scree."""

VERSION = "0.1.0"
