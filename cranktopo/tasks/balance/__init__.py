"""Balance of the whole engine: free forces and moments, counterweights, balancer shafts."""
