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
  "libcli11-dev the command line"
  "gnuplot-nox draws the plots"
)

# To build and run the tests and benchmarks (./test), besides those above.
packages_test=(
  "libgtest-dev unit tests"
  "libgmock-dev unit tests"
  "libmujoco-dev independent multibody dynamics to compare with"
  "libbenchmark-dev benchmarks"
  "liblapacke-dev LAPACK from C, the yardstick of the benchmarks"
  "libopenblas-dev an optimised LAPACK"
)

# For ./test --long.
packages_long=(
  "clang compiles the fuzz targets"
  "libclang-rt-dev libFuzzer and sanitizers for clang"
)
