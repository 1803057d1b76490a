# Builds and runs the benchmarks. Sourced by ../dev. Arguments go to every benchmark program, for example
#   ./dev bench --benchmark_filter=exact
setup
cmake --preset release -DISOPATH_BENCH=ON >/dev/null
cmake --build --preset release
[ $# -gt 0 ] || build/release/bench/field_table
for program in build/release/bench/*_bench; do
  "$program" "$@"
done
