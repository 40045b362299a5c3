"""How grains are put into the domain: in batches on a lattice, or at random places."""
