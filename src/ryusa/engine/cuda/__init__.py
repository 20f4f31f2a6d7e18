"""The CUDA engine: the same laws behind the same seam; loaded only when asked for (design/0009)."""
