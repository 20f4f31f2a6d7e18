"""The CUDA engine: the same laws behind the same protocol, imported only when it is created (design/0009)."""
