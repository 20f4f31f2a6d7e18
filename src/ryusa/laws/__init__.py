"""Physics as small pure functions of scalars; each names its equation or source."""
