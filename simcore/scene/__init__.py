"""What is to be packed: the specification in SI units, its sizes, its domain and the scene made of them."""
