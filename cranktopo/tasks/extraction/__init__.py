"""From a density field to a watertight surface."""
