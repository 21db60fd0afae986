"""Fatigue safety of throws with true fillets, and the crankshaft rule IACS UR M53."""
