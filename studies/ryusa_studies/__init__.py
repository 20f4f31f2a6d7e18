"""Studies with registered bands: the paper redone (`osada2004`), and the comparison with references."""
