"""Workshop drawing of a throw, and sketches of its keys."""
