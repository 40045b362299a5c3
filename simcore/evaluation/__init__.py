"""What is computed from a finished packing: porosity, order over height, contacts and directions."""
