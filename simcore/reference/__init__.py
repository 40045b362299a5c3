"""Tables that results are compared with: those of Rettinger et al. (2022) and the committed rows."""
