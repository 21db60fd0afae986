"""A local page on which a web is dragged, watched, compared and exported."""
