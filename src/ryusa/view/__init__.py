"""Grains in motion: a page to look at a run in a browser, and films."""
