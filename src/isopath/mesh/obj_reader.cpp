#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "isopath/core/error.h"
#include "isopath/mesh/mesh_formats.h"
#include "isopath/mesh/text_scanner.h"

namespace isopath {
namespace {

/// Statements that carry no surface, or none that isopath uses.
constexpr std::array<std::string_view, 36> ignored = {
    "vn",        "vt",     "vp",    "o",      "g",     "s",        "mg",       "usemtl", "mtllib",
    "usemap",    "maplib", "l",     "p",      "bevel", "c_interp", "d_interp", "lod",    "shadow_obj",
    "trace_obj", "ctech",  "stech", "cstype", "deg",   "bmat",     "step",     "curv",   "curv2",
    "surf",      "parm",   "trim",  "hole",   "scrv",  "sp",       "end",      "con",    "call"};

class ObjReader {
 public:
  ObjReader(std::string_view content, Progress& progress) : scanner_(content, '#'), progress_(progress) {}

  RawMesh read() {
    std::size_t lines = 0;
    while (scanner_.next_line()) {
      if (lines++ % 16384 == 0) progress_.checkpoint();
      const std::string_view keyword = scanner_.word();
      if (keyword == "v") {
        read_vertex();
      } else if (keyword == "f" || keyword == "fo") {
        read_face();
      } else if (std::find(ignored.begin(), ignored.end(), keyword) == ignored.end()) {
        if (unknown_lines_++ == 0) unknown_ = fmt::format("'{}' in line {}", shown(keyword), scanner_.line());
      }
    }
    if (forward_.line > 0) refuse_index(forward_.value, forward_.line);
    if (unknown_lines_ > 0) {
      mesh_.notes.push_back(
          fmt::format("{} lines with an unknown keyword were skipped, first {}", unknown_lines_, unknown_));
    }
    return std::move(mesh_);
  }

 private:
  void read_vertex() {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = scanner_.number("a vertex coordinate");
    mesh_.soup.positions.push_back(p);
    if (forward_.value <= count()) forward_ = {};
  }

  void read_face() {
    corners_.clear();
    for (std::string_view word = next_corner(); !word.empty(); word = next_corner()) {
      corners_.push_back(to_vertex(word.substr(0, word.find('/'))));
    }
    if (corners_.size() < 3) {
      scanner_.fail("a face needs three corners", fmt::format("{} corners", corners_.size()),
                    "remove the face or export the file again");
    }
    mesh_.add_polygon(corners_);
  }

  /// A face may go on in the next line after a backslash.
  std::string_view next_corner() {
    std::string_view word = scanner_.word();
    while (word == "\\") word = scanner_.next_line() ? scanner_.word() : std::string_view();
    return word;
  }

  Index to_vertex(std::string_view digits) {
    const long long number = scanner_.to_integer(digits, "a vertex index");
    if (number == 0 || number < -count() || number > std::numeric_limits<Index>::max()) {
      refuse_index(number, scanner_.line());
    }
    // A face may come before its vertices; the largest such index must have been defined in the end.
    if (number > count() && number > forward_.value) forward_ = {number, scanner_.line()};
    return static_cast<Index>(number > 0 ? number - 1 : count() + number);
  }

  [[noreturn]] void refuse_index(long long number, std::size_t line) const {
    throw Error(ErrorCode::bad_input, "a face refers to a vertex that does not exist",
                {.element = fmt::format("line {}", line),
                 .value = fmt::format("vertex {} of {}", number, count()),
                 .advice = "OBJ counts vertices from 1, or backwards from -1; the file is damaged or cut short"});
  }

  long long count() const { return static_cast<long long>(mesh_.soup.positions.size()); }

  struct ForwardReference {
    long long value = 0;
    std::size_t line = 0;
  };

  TextScanner scanner_;
  Progress& progress_;
  RawMesh mesh_;
  std::vector<Index> corners_;
  ForwardReference forward_;
  std::size_t unknown_lines_ = 0;
  std::string unknown_;
};

}  // namespace

RawMesh read_obj(std::string_view content, Progress& progress) { return ObjReader(content, progress).read(); }

}  // namespace isopath
