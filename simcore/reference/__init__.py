"""Tables with which results are compared: those of Rettinger et al. (2022) and the committed rows."""
