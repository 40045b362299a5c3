"""The report page of a campaign and its figures."""
