#include "isopath/core/error.h"

#include <fmt/format.h>

#include <utility>

namespace isopath {
namespace {

std::string full_message(const std::string& what, const ErrorWhere& where) {
  std::string message;
  if (!where.file.empty()) message += where.file + ": ";
  if (!where.element.empty()) message += where.element + ": ";
  message += what;
  if (!where.value.empty()) message += fmt::format(" ({})", where.value);
  if (!where.advice.empty()) message += fmt::format("\n  {}", where.advice);
  return message;
}

}  // namespace

Error::Error(ErrorCode code, std::string what, ErrorWhere where)
    : std::runtime_error(full_message(what, where)), code_(code), summary_(std::move(what)), where_(std::move(where)) {}

Error Error::in_file(const std::string& file) const {
  ErrorWhere where = where_;
  if (where.file.empty()) where.file = file;
  return {code_, summary_, where};
}

}  // namespace isopath
