"""The counterweight of a web: table, sector, the fillet in its corners, its distances."""
