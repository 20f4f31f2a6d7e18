"""Grains in files of other programs: what `ryusa export` writes, and what a case can start from."""
