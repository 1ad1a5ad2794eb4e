# shellcheck shell=bash disable=SC2034  # sourced; the lists are read by scripts/setup.sh
# The Debian 12 packages that this project needs: "package reason". The only place that lists them.

# To build and run the program (./hydrapod).
packages_program=(
  "g++ the compiler"
  "cmake configures the build"
  "ninja-build runs the build"
  "ccache keeps compiled files for the next build"
  "libeigen3-dev linear algebra"
  "libfmt-dev text formatting"
  "nlohmann-json3-dev JSON output"
  "libtomlplusplus-dev reads machine files"
  "libudunits2-dev units of measurement"
  "libboost-dev distributions and sequences (Boost.Math, Boost.Random), the server of the studio (Boost.Asio, Boost.Beast)"
  "libcli11-dev the command line"
  "libsundials-dev integrates the equations of motion"
  "libceres-dev least squares, for calibration"
  "libnlopt-dev constrained optimisation, for design (SLSQP and COBYLA, whose licences are permissive)"
  "libhdf5-dev records in HDF5"
  "zlib1g-dev compressed variables in MAT files"
  "libxxhash-dev checksums of records"
  "libssl-dev checksums of files that results name, and authenticated packets (SHA-256)"
  "gnuplot-nox draws the plots"
  "nodejs bundles the page of the report"
  "ca-certificates lets npm trust its registry"
  "npm fetches what the page is made of (three.js, uPlot, esbuild)"
)

# Tools that many have from elsewhere: where the tool is there, its package is not asked for.
declare -A tool_of=([nodejs]=node [npm]=npm [chromium]=chromium [emscripten]=em++)

# To build and run the tests and benchmarks (./test), besides those above.
packages_test=(
  "libgtest-dev unit tests"
  "libgmock-dev unit tests"
  "libmatio-dev a second opinion on MAT files"
  "libmujoco-dev independent multibody dynamics to compare with"
  "libbenchmark-dev benchmarks"
  "libopenmpi-dev studies by many ranks (MPI); the program is built without it as well"
  "openmpi-bin starts these ranks (mpirun)"
  "liblapacke-dev LAPACK from C, the yardstick of the benchmarks"
  "libopenblas-dev an optimised LAPACK"
  "chromium opens the pages in their tests"
  "emscripten compiles the page's core anew, which must give the bytes that are kept"
  "liburdfdom-tools parses exported URDF files (check_urdf)"
  "libsdformat-dev parses exported SDF files"
  "pkg-config finds the parser of SDF files"
  "python3-scipy reads exported files, and a second opinion on linear algebra"
  "python3 puts mistakes into the sources, to see whether the tests notice"
)

# To build and run the Python package (./hydrapod python, and ./test).
packages_python=(
  "pybind11-dev binds C++ to Python"
  "python3-dev headers of Python"
  "python3-numpy arrays"
)

# To make Debian packages (scripts/package.sh, and ./test).
packages_deb=(
  "dpkg-dev finds the packages that a binary depends on"
  "file tells binaries from other files"
)

# For the tests of the Python package (./test), besides those above.
packages_python_test=(
  "python3-pytest runs them"
  "python3-pip makes the wheel"
  "python3-setuptools makes the wheel"
  "python3-wheel makes the wheel"
  "python3-h5py opens results and records as other programs do"
  "python3-xarray records as arrays with names, and tables of pandas"
  "mypy checks the types"
  "python3-matplotlib draws the plots"
)

# For ./test --sanitize-files, --sanitize and --long.
packages_sanitize=(
  "clang compiles with sanitizers, and the fuzz targets"
  "libclang-rt-dev libFuzzer and sanitizers for clang"
)
