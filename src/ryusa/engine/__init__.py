"""Engines: who touches whom, and one step for all of them."""
