#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/progress.h"

namespace isopath::app {

/// The flags every command takes.
struct CommonFlags {
  bool json = false;
  bool quiet = false;
  int threads = 0;  ///< 0: as many as the machine has
};

/// What a command does once the command line is understood.
using Action = std::function<void()>;

/// Adds --json, --quiet and --threads to a command.
void add_common_flags(CLI::App& command, CommonFlags& flags);

/// Draws a bar with the time left on a terminal, plain lines elsewhere, nothing when quiet; all on stderr.
/// Hears Ctrl-C.
class ConsoleProgress final : public Progress {
 public:
  explicit ConsoleProgress(bool quiet);
  ~ConsoleProgress() override;

  void stage(std::string_view name) override;
  void at(double fraction) override;
  bool cancelled() const override;

 private:
  using Clock = std::chrono::steady_clock;
  void draw(double fraction, Clock::time_point now);
  void clear_line();

  const bool quiet_;
  const bool terminal_;
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point stage_start_;
  Clock::time_point last_drawn_;
  bool line_open_ = false;
};

/// From here on SIGINT, SIGTERM and SIGHUP make every ConsoleProgress report that it is cancelled.
void listen_for_interrupts();

/// One line a warning on stderr, unless quiet.
void print_warnings(const CommonFlags& flags, const std::vector<std::string>& warnings);

/// Writes text to stdout; throws Error(bad_input) when stdout cannot be written.
void print(std::string_view text);
/// Writes it to stdout, indented. Bytes that are not UTF-8, as a file name may have, become replacement characters.
void print_json(const nlohmann::ordered_json& json);

/// Limits the threads to the flag, runs the action, and turns what it throws into a message on stderr and an exit
/// status: 0 done, 2 wrong usage, 3 bad input, 4 no plan possible, 130 interrupted, 1 a fault of ours.
int run(const CommonFlags& flags, const Action& action);

}  // namespace isopath::app
