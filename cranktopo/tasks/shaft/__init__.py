"""The whole crankshaft from condensed throws."""
