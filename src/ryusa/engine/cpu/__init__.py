"""The CPU engine: compiled threads that step blocks of grains and wait for each other at a barrier."""
