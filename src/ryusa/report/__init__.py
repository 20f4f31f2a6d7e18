"""One page about one run or several: what ran, what it found, its pictures, its grains in motion."""
