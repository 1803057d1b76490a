// Writes the programs and tool paths that LinuxCNC's interpreter is asked about, into the folder given.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "isopath/core/atomic_file.h"
#include "isopath/post/csv.h"
#include "isopath/post/gcode.h"
#include "post/test_paths.h"

namespace isopath {
namespace {

void write(const std::filesystem::path& folder, const std::string& name, const ToolPath& path,
           const GcodeOptions& options) {
  write_file_atomically(folder / (name + ".ngc"), gcode(path, options));
  write_file_atomically(folder / (name + ".csv"), tool_csv(path));
}

void write_all(const std::filesystem::path& folder) {
  const ToolPath straight = test::full_path(test::wavy_zigzag(), AxisMode::fixed_direction);
  write(folder, "zigzag_3_axes", straight, {.axes = GcodeAxes::xyz});
  write(folder, "zigzag_5_axes", test::full_path(test::wavy_zigzag()), {});
  write(folder, "helix_5_axes", test::full_path(test::cylinder_helix()), {.process = Process::spray});
  write(folder, "near_pole_5_axes", test::full_path(test::near_pole()), {});
  write(folder, "spiral_5_axes", test::full_path(test::sphere_spiral()), {});
}

}  // namespace
}  // namespace isopath

int main(int count, char** arguments) {
  try {
    if (count != 2) throw std::invalid_argument("usage: write_programs FOLDER");
    isopath::write_all(arguments[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
