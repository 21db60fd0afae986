"""What every room uses: errors, units, files, scene tables, sections; it knows no crank."""
