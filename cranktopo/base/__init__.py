"""Tools of every room: errors, units, files, scene tables, sections; it knows no crank."""
