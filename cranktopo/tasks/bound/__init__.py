"""Bounds that no web of an envelope can beat, proven in the optimiser's discrete model."""
