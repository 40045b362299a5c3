"""The page that predicts the porosity of measured grains in a browser: one file, without a server."""
