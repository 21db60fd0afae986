"""Viewer: the 3D view of an HTML page, its data and its script."""
