#pragma once

#include <stdexcept>
#include <string>

namespace isopath {

/// What kind of thing went wrong; a program maps it to its exit status.
enum class ErrorCode {
  bad_usage,  ///< an argument or option is wrong
  bad_input,  ///< a file or its content is wrong
  no_plan,    ///< the input is fine, but no plan is possible
  cancelled,  ///< the caller asked to stop
  internal,   ///< a fault of isopath
};

/// Where an error was found. Empty members are left out of the message.
struct ErrorWhere {
  std::string file = {};     ///< path as the caller gave it
  std::string element = {};  ///< "line 12", "triangle 7", "option --spacing"
  std::string value = {};    ///< the offending value, and its limit where there is one
  std::string advice = {};   ///< what the reader can do about it
};

/// The only exception that isopath throws on purpose.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, std::string what, ErrorWhere where = {});

  ErrorCode code() const { return code_; }
  const std::string& summary() const { return summary_; }
  const ErrorWhere& where() const { return where_; }

  /// The same error, with the file filled in where it was still unknown.
  Error in_file(const std::string& file) const;

 private:
  ErrorCode code_;
  std::string summary_;
  ErrorWhere where_;
};

}  // namespace isopath
