"""The kit of all reports: page, HTML, Markdown, tables, plots, 3D view; it knows no task."""
