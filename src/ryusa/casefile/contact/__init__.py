"""[contact] and [rolling]: springs, dashpots, slider and rolling resistance of every contact."""
