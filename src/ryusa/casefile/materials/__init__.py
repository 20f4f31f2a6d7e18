"""[materials.NAME] and [[pairs]]: keys, checks, values and rows."""
