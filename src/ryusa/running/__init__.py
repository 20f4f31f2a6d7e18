"""The one loop: build, advance, record, watch, stop."""
