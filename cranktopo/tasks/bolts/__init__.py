"""Bolted joints by VDI 2230 and by Shigley."""
