"""Several targets beside a baseline: tables, plots and one page."""
