"""Files of a finished packing for other programs: surfaces, voxels, the network of contacts."""
