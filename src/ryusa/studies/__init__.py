"""Studies that come with the package; each has its parts, its cases and its page in a folder of its own."""
