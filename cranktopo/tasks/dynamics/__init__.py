"""Dynamics of the whole shaft: its steady vibration under the cylinders' forces, bending and axial too."""
