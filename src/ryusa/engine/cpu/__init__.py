"""The CPU engine: compiled threads that step blocks of grains and meet at a barrier."""
