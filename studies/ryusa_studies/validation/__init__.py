"""Ours beside every reference: one short file per reference, with its errors and how large they may be."""
