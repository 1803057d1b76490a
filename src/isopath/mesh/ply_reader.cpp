#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/mesh_formats.h"
#include "isopath/mesh/text_scanner.h"

namespace isopath {
namespace {

constexpr const char* damaged = "the file is cut short or damaged; export it again";

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count_type;  ///< set for a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
  std::size_t line = 0;
};

enum class Encoding { ascii, little_endian, big_endian };

struct PlyHeader {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t end = 0;
};

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> sizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

Type parse_type(const TextScanner& scanner, std::string_view word) {
  constexpr std::array<std::array<std::string_view, 2>, 8> names = {{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (word == names[i][0] || word == names[i][1]) return static_cast<Type>(i);
  }
  scanner.fail("unknown PLY type", word, "PLY knows char, uchar, short, ushort, int, uint, float and double");
}

Property parse_property(TextScanner& scanner) {
  Property property;
  std::string_view word = scanner.word();
  if (word == "list") {
    property.count_type = parse_type(scanner, scanner.word());
    if (*property.count_type == Type::float32 || *property.count_type == Type::float64) {
      scanner.fail("the length of a list must be an integer type", {}, damaged);
    }
    word = scanner.word();
  }
  property.type = parse_type(scanner, word);
  property.name = scanner.word();
  if (property.name.empty()) scanner.fail("a property has no name", {}, damaged);
  return property;
}

Encoding parse_encoding(TextScanner& scanner) {
  const std::string_view word = scanner.word();
  if (word == "ascii") return Encoding::ascii;
  if (word == "binary_little_endian") return Encoding::little_endian;
  if (word == "binary_big_endian") return Encoding::big_endian;
  scanner.fail("unknown PLY encoding", word, "use ascii, binary_little_endian or binary_big_endian");
}

Element parse_element(TextScanner& scanner) {
  Element element{.name = std::string(scanner.word()), .properties = {}, .line = scanner.line()};
  const std::string_view word = scanner.word();
  const long long count = scanner.to_integer(word, "the number of elements");
  if (count < 0) scanner.fail("the number of elements is negative", word, damaged);
  element.count = static_cast<std::uint64_t>(count);
  return element;
}

PlyHeader parse_header(TextScanner& scanner) {
  PlyHeader header;
  bool encoding_seen = false;
  if (!scanner.next_line() || scanner.word() != "ply") {
    scanner.fail("the keyword 'ply' is missing", scanner.rest_of_line(), "the first line of a PLY file is 'ply'");
  }
  while (scanner.next_line()) {
    const std::string_view keyword = scanner.word();
    if (keyword == "end_header") {
      if (!encoding_seen) scanner.fail("the header has no 'format' line", {}, damaged);
      header.end = scanner.next_line_offset();
      return header;
    }
    if (keyword == "format") {
      header.encoding = parse_encoding(scanner);
      encoding_seen = true;
    } else if (keyword == "element") {
      header.elements.push_back(parse_element(scanner));
    } else if (keyword == "property") {
      if (header.elements.empty()) scanner.fail("a property comes before any element", {}, damaged);
      header.elements.back().properties.push_back(parse_property(scanner));
    } else if (keyword != "comment" && keyword != "obj_info") {
      scanner.fail("unknown keyword in the PLY header", keyword, damaged);
    }
  }
  scanner.fail("the PLY header has no 'end_header'", {}, damaged);
}

/// One value at a time from the text that follows the header.
class AsciiSource {
 public:
  AsciiSource(TextScanner& scanner) : scanner_(scanner) {}

  void begin_row(const Element& element, std::uint64_t row) {
    if (element.properties.empty() || scanner_.next_line()) return;
    scanner_.fail(fmt::format("the file ends before {} {} of {}", element.name, row, element.count), {}, damaged);
  }
  double real(Type) { return scanner_.number("a property"); }
  long long whole(Type) { return scanner_.integer("an index or list length"); }
  void check_list(long long n) {
    if (n < 0) fail("a list has a negative length", fmt::format("{}", n));
  }
  void skip(Type, long long count) {
    for (long long i = 0; i < count; ++i) {
      if (scanner_.word().empty()) fail("a property is missing", {});
    }
  }
  [[noreturn]] void fail(std::string what, std::string value) { scanner_.fail(std::move(what), value, damaged); }
  std::uint64_t bytes_left() const { return scanner_.bytes_left() + 1; }
  static std::uint64_t least_bytes(const Property&) { return 2; }  // a digit and a blank
  std::string rest() {
    return scanner_.next_line() ? fmt::format("text from line {} on", scanner_.line()) : std::string();
  }

 private:
  TextScanner& scanner_;
};

/// One value at a time from the bytes that follow the header.
class BinarySource {
 public:
  BinarySource(std::string_view content, std::size_t begin, bool big_endian)
      : content_(content), at_(begin), big_endian_(big_endian) {}

  void begin_row(const Element& element, std::uint64_t row) {
    element_ = &element.name;
    row_ = row;
  }
  double real(Type type) {
    const char* data = take(size_of(type));
    switch (type) {
      case Type::float32:
        return load<float>(data, big_endian_);
      case Type::float64:
        return load<double>(data, big_endian_);
      default:
        return static_cast<double>(integer_at(data, type));
    }
  }
  long long whole(Type type) {
    const char* data = take(size_of(type));
    if (type == Type::float32 || type == Type::float64) fail("an index is stored as a floating-point number", {});
    return integer_at(data, type);
  }
  void check_list(long long n) {
    if (n < 0) fail("a list has a negative length", fmt::format("{}", n));
    if (static_cast<std::uint64_t>(n) > bytes_left()) fail("a list is longer than the file", fmt::format("{}", n));
  }
  void skip(Type type, long long count) { take(size_of(type) * static_cast<std::size_t>(count)); }
  [[noreturn]] void fail(std::string what, std::string value) {
    throw Error(
        ErrorCode::bad_input, std::move(what),
        {.element = fmt::format("{} {}, byte {}", *element_, row_, at_), .value = std::move(value), .advice = damaged});
  }
  std::uint64_t bytes_left() const { return content_.size() - at_; }
  static std::uint64_t least_bytes(const Property& property) {
    return size_of(property.count_type ? *property.count_type : property.type);
  }
  std::string rest() const { return bytes_left() > 0 ? fmt::format("{} bytes", bytes_left()) : std::string(); }

 private:
  const char* take(std::size_t size) {
    if (bytes_left() < size)
      fail("the file ends inside an element", fmt::format("{} bytes missing", size - bytes_left()));
    const char* data = content_.data() + at_;
    at_ += size;
    return data;
  }
  long long integer_at(const char* data, Type type) const {
    switch (type) {
      case Type::int8:
        return load<std::int8_t>(data);
      case Type::uint8:
        return load<std::uint8_t>(data);
      case Type::int16:
        return load<std::int16_t>(data, big_endian_);
      case Type::uint16:
        return load<std::uint16_t>(data, big_endian_);
      case Type::int32:
        return load<std::int32_t>(data, big_endian_);
      default:
        return load<std::uint32_t>(data, big_endian_);
    }
  }

  std::string_view content_;
  std::size_t at_;
  bool big_endian_;
  const std::string* element_ = nullptr;
  std::uint64_t row_ = 0;
};

template <typename Source>
void skip_property(Source& source, const Property& property) {
  long long n = 1;
  if (property.count_type) {
    n = source.whole(*property.count_type);
    source.check_list(n);
  }
  source.skip(property.type, n);
}

template <typename Source>
void read_vertex(Source& source, const Element& element, RawMesh& mesh) {
  Vec3 p = Vec3::Zero();
  for (const Property& property : element.properties) {
    const bool coordinate = property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z';
    if (coordinate && !property.count_type) {
      p[property.name[0] - 'x'] = source.real(property.type);
    } else {
      skip_property(source, property);
    }
  }
  mesh.soup.positions.push_back(p);
}

bool is_face_list(const Property& property) {
  return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

template <typename Source>
void read_face(Source& source, const Element& element, std::vector<Index>& corners, std::uint64_t n_vertices,
               RawMesh& mesh) {
  for (const Property& property : element.properties) {
    if (!is_face_list(property)) {
      skip_property(source, property);
      continue;
    }
    const long long n = source.whole(*property.count_type);
    source.check_list(n);
    if (n < 3) source.fail("a face needs three corners", fmt::format("{} corners", n));
    corners.clear();
    for (long long i = 0; i < n; ++i) {
      const long long index = source.whole(property.type);
      if (index < 0 || index >= static_cast<long long>(n_vertices)) {
        source.fail("vertex index out of range", fmt::format("{} of {} vertices", index, n_vertices));
      }
      corners.push_back(static_cast<Index>(index));
    }
    mesh.add_polygon(corners);
  }
}

template <typename Source>
RawMesh read_elements(Source& source, const PlyHeader& header, std::uint64_t n_vertices, Progress& progress) {
  RawMesh mesh;
  std::vector<Index> corners;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    std::uint64_t least = 0;
    for (const Property& property : element.properties) least += source.least_bytes(property);
    check_count(fmt::format("'{}' elements", shown(element.name)), element.count, least, source.bytes_left(),
                fmt::format("line {}", element.line));
    if (element.name == "vertex") mesh.soup.positions.reserve(element.count);
    if (element.name == "face") mesh.soup.triangles.reserve(element.count);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (row % 16384 == 0) progress.checkpoint();
      source.begin_row(element, row);
      if (element.name == "vertex") {
        read_vertex(source, element, mesh);
      } else if (element.name == "face") {
        read_face(source, element, corners, n_vertices, mesh);
      } else {
        for (const Property& property : element.properties) skip_property(source, property);
      }
    }
  }
  if (const std::string rest = source.rest(); !rest.empty()) {
    mesh.notes.push_back(fmt::format("{} after the last element: ignored", rest));
  }
  return mesh;
}

/// Number of vertices, after checking that the header describes a surface.
std::uint64_t check_header(const PlyHeader& header) {
  const auto missing = [](std::string what, const Element* element) -> Error {
    return {ErrorCode::bad_input,
            std::move(what),
            {.element = element == nullptr ? "PLY header" : fmt::format("line {}", element->line),
             .advice = "a surface needs an element 'vertex' with x, y, z and an element 'face' with the list "
                       "vertex_indices; export the file again with its faces"}};
  };
  std::uint64_t n_vertices = 0;
  int vertex_elements = 0;
  int face_elements = 0;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      int coordinates = 0;
      for (const Property& property : element.properties) {
        coordinates += !property.count_type && (property.name == "x" || property.name == "y" || property.name == "z");
      }
      if (coordinates != 3) throw missing("the vertices have no x, y and z", &element);
      n_vertices = element.count;
      ++vertex_elements;
    } else if (element.name == "face") {
      int lists = 0;
      for (const Property& property : element.properties) lists += is_face_list(property);
      if (lists != 1) throw missing("the faces have no single list of vertices", &element);
      ++face_elements;
    }
  }
  if (vertex_elements != 1) throw missing("the file has no single element 'vertex'", nullptr);
  if (face_elements != 1) throw missing("the file has no single element 'face'", nullptr);
  return n_vertices;
}

}  // namespace

RawMesh read_ply(std::string_view content, Progress& progress) {
  TextScanner scanner(content);
  const PlyHeader header = parse_header(scanner);
  const std::uint64_t n_vertices = check_header(header);
  if (header.encoding == Encoding::ascii) {
    AsciiSource source(scanner);
    return read_elements(source, header, n_vertices, progress);
  }
  BinarySource source(content, header.end, header.encoding == Encoding::big_endian);
  return read_elements(source, header, n_vertices, progress);
}

}  // namespace isopath
