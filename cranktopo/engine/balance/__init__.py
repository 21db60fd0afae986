"""Balance of throw and engine: unbalance, free forces and moments, balancer shafts, main bearings."""
