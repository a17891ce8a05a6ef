"""Where a residual lies: in which coordinate, how surely, and in words."""
