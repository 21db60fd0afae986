"""Natural frequencies and shapes of the whole crankshaft on its bearings, at rest and over speed."""
