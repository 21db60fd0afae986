"""Workshop drawing of the whole crank."""
