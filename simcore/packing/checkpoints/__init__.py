"""Files that an interrupted packing goes on from."""
