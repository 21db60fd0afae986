"""The counterweight of a web: table, sector with its fillets, the circle of a fillet."""
