"""The shaft on its bearings with the safety of every fillet over the cycle and over speed."""
