"""[[walls]] and [[planes]]: keys, checks, places and rows."""
