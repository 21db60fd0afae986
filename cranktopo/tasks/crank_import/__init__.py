"""A crank from CAD becomes a design: axes, journals, throws and webs are recognised on its faces."""
