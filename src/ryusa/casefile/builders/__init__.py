"""[build]: keys of each builder, the table of grains, and how many grains of which size they place."""
