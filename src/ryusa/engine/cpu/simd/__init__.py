"""Vector registers, prefetch and arrays without an owner: what Numba does not offer by itself."""
