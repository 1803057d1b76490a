#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// The limits of a number in a job file.
struct NumberRange {
  double least = -infinity;
  double greatest = infinity;
  bool least_excluded = false;
};

/// The fields of one mapping of a YAML file, read key by key. Every complaint is an Error(bad_input) with file, line,
/// key, value and what is allowed. A key that is absent leaves the variable as it is; `finish` refuses keys that
/// nobody asked for.
class YamlFields {
 public:
  /// Throws when `node` is not a mapping. `prefix` names the mapping in messages: "" or "tool.".
  YamlFields(const YAML::Node& node, std::string file, std::string prefix = {});

  void read(const std::string& key, double& value, const NumberRange& range = {});
  void read(const std::string& key, bool& value);
  void read(const std::string& key, Vec3& value);
  /// Hands the text to `accept`; an Error thrown by it gets the file, line and key.
  void read_text(const std::string& key, const std::function<void(const std::string&)>& accept);
  void read_texts(const std::string& key, const std::function<void(const std::string&)>& accept);
  /// The mapping under a key, or an empty one.
  YamlFields section(const std::string& key);

  bool has(const std::string& key) const { return static_cast<bool>(node_[key]); }
  [[noreturn]] void missing(const std::string& key, std::string advice) const;
  void finish() const;

 private:
  YAML::Node take(const std::string& key);
  [[noreturn]] void reject(const YAML::Node& node, const std::string& key, std::string what, std::string value,
                           std::string advice = {}) const;
  std::string scalar(const YAML::Node& node, const std::string& key, const char* wanted) const;
  double number(const YAML::Node& node, const std::string& key) const;
  void accept_text(const YAML::Node& node, const std::string& key,
                   const std::function<void(const std::string&)>& accept) const;

  YAML::Node node_;
  std::string file_;
  std::string prefix_;
  std::vector<std::string> known_;
};

/// Parses YAML text; a syntax error becomes an Error(bad_input) with file and line.
YAML::Node parse_yaml(const std::string& text, const std::string& file);

/// Text as a double-quoted YAML scalar.
std::string yaml_quoted(std::string_view text);

}  // namespace isopath
