"""Compiled code of the packaged cases of ryusa; `ryusa doctor` says whether it is used."""
