#include "isopath/plan/yaml_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "isopath/core/error.h"

namespace isopath {
namespace {

std::string describe(const YAML::Node& node) {
  if (node.IsScalar()) return fmt::format("'{}'", node.Scalar());
  if (node.IsSequence()) return fmt::format("a list of {}", node.size());
  if (node.IsMap()) return "a mapping";
  return "nothing";
}

std::string line_of(const YAML::Mark& mark) { return mark.is_null() ? "" : fmt::format("line {}: ", mark.line + 1); }

std::string range_text(const NumberRange& range) {
  const char* above = range.least_excluded ? "above" : "at least";
  if (range.greatest == infinity) return fmt::format("{} {}", above, range.least);
  return fmt::format("{} {} and at most {}", above, range.least, range.greatest);
}

}  // namespace

YamlFields::YamlFields(const YAML::Node& node, std::string file, std::string prefix)
    : node_(node), file_(std::move(file)), prefix_(std::move(prefix)) {
  if (!node_.IsMap() && !node_.IsNull()) {
    throw Error(ErrorCode::bad_input, "a mapping 'key: value' belongs here",
                {.file = file_, .element = line_of(node_.Mark()) + prefix_, .value = describe(node_)});
  }
}

void YamlFields::reject(const YAML::Node& node, const std::string& key, std::string what, std::string value,
                        std::string advice) const {
  throw Error(ErrorCode::bad_input, std::move(what),
              {.file = file_,
               .element = line_of(node.Mark()) + prefix_ + key,
               .value = std::move(value),
               .advice = std::move(advice)});
}

YAML::Node YamlFields::take(const std::string& key) {
  known_.push_back(key);
  if (!node_.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  return std::as_const(node_)[key];
}

std::string YamlFields::scalar(const YAML::Node& node, const std::string& key, const char* wanted) const {
  if (!node.IsScalar()) reject(node, key, fmt::format("{} belongs here", wanted), describe(node));
  return node.Scalar();
}

double YamlFields::number(const YAML::Node& node, const std::string& key) const {
  const std::string text = scalar(node, key, "a number");
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    reject(node, key, "a number belongs here", describe(node));
  }
  return value;
}

void YamlFields::read(const std::string& key, double& value, const NumberRange& range) {
  const YAML::Node node = take(key);
  if (!node) return;
  const double given = number(node, key);
  if (given < range.least || given > range.greatest || (range.least_excluded && given == range.least)) {
    reject(node, key, "the number is out of range", fmt::format("{}, allowed is {}", given, range_text(range)));
  }
  value = given;
}

void YamlFields::read(const std::string& key, bool& value) {
  const YAML::Node node = take(key);
  if (!node) return;
  const std::string text = scalar(node, key, "true or false");
  if (text != "true" && text != "false") reject(node, key, "true or false belongs here", describe(node));
  value = text == "true";
}

void YamlFields::read(const std::string& key, Vec3& value) {
  const YAML::Node node = take(key);
  if (!node) return;
  if (!node.IsSequence() || node.size() != 3) reject(node, key, "three numbers [x, y, z] belong here", describe(node));
  for (int i = 0; i < 3; ++i) value[i] = number(node[i], key);
}

void YamlFields::accept_text(const YAML::Node& node, const std::string& key,
                             const std::function<void(const std::string&)>& accept) const {
  const std::string text = scalar(node, key, "a text");
  try {
    accept(text);
  } catch (const Error& error) {
    const std::string inner = error.where().element.empty() ? "" : ": " + error.where().element;
    reject(node, key + inner, error.summary(), error.where().value, error.where().advice);
  }
}

void YamlFields::read_text(const std::string& key, const std::function<void(const std::string&)>& accept) {
  const YAML::Node node = take(key);
  if (node) accept_text(node, key, accept);
}

void YamlFields::read_texts(const std::string& key, const std::function<void(const std::string&)>& accept) {
  const YAML::Node node = take(key);
  if (!node) return;
  if (!node.IsSequence()) reject(node, key, "a list [a, b] belongs here", describe(node));
  for (std::size_t i = 0; i < node.size(); ++i) accept_text(node[i], key, accept);
}

YamlFields YamlFields::section(const std::string& key) {
  const YAML::Node node = take(key);
  return {node ? node : YAML::Node(YAML::NodeType::Null), file_, prefix_ + key + "."};
}

void YamlFields::missing(const std::string& key, std::string advice) const {
  reject(node_, key, "this key is missing", {}, std::move(advice));
}

void YamlFields::finish() const {
  if (!node_.IsMap()) return;
  std::vector<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : describe(entry.first);
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      reject(entry.first, key, "unknown key", {}, fmt::format("known here: {}", fmt::join(known_, ", ")));
    }
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) reject(entry.first, key, "the key is given twice", {});
    seen.push_back(key);
  }
}

YAML::Node parse_yaml(const std::string& text, const std::string& file) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Error(ErrorCode::bad_input, "not a YAML file: " + error.msg,
                {.file = file, .element = fmt::format("line {}", error.mark.line + 1)});
  }
}

std::string yaml_quoted(std::string_view text) {
  // A JSON string is a double-quoted YAML scalar.
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace isopath
