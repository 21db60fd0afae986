"""Designs to begin with: built-in ones, copies, templates, and the webs that runs left."""
