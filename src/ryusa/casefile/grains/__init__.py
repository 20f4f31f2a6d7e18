"""[grains] and [shapes]: keys, and what follows from them."""
