"""Bodies from CAD as half throws: found, placed, meshed."""
