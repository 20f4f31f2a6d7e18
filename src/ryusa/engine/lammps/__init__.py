"""LAMMPS behind the protocol of engines: on one processor, or shared among ranks of MPI (design/0025)."""
