"""Pages: what a report says, section by section, and how it is written as HTML or Markdown."""
