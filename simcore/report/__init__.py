"""The page of a campaign and its figures."""
