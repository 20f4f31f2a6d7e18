"""[time], [stop], [[timeline]] and [record]: keys, checks, values and rows."""
