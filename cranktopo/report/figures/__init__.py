"""Figures: matplotlib plots and shaded pictures of finished results."""
