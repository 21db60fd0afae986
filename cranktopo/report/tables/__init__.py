"""Tables and lines of text: finished results for a terminal, Markdown, CSV and JSON."""
