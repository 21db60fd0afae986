"""The raw part that a die forges: table, outlines with draft, bodies of a raw half throw."""
