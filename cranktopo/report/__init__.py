"""Reports: pages, figures, tables and the 3D view of finished results; nothing is solved or meshed here."""
