#include "console.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>

#include "isopath/core/error.h"

namespace isopath::app {
namespace {

constexpr int exit_fault = 1;
constexpr int exit_interrupted = 130;

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

/// A second signal ends the program at once, should a step not come to its next checkpoint.
extern "C" void on_interrupt(int) {
  if (!interrupted.exchange(true)) return;
  constexpr std::string_view message = "\nisopath: interrupted twice: ended at once\n";
  const auto written = ::write(STDERR_FILENO, message.data(), message.size());  // formatting is not safe here
  ::_exit(written < 0 ? exit_fault : exit_interrupted);
}

void say(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

int status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_usage:
      return 2;
    case ErrorCode::bad_input:
      return 3;
    case ErrorCode::no_plan:
      return 4;
    case ErrorCode::cancelled:
      return exit_interrupted;
    case ErrorCode::internal:
      break;
  }
  return exit_fault;
}

void report_fault(std::string_view what) {
  say(fmt::format(
      "isopath: error: {}\n  this is a fault of isopath: please report it with the command and the input file\n",
      what));
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

}  // namespace

void add_common_flags(CLI::App& command, CommonFlags& flags) {
  command.add_flag("--json", flags.json, "Print one JSON object on stdout");
  command.add_flag("--quiet", flags.quiet, "No progress and no warnings on stderr");
  command.add_option("--threads", flags.threads, "Threads to use; 0 takes all of the machine")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

ConsoleProgress::ConsoleProgress(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

ConsoleProgress::~ConsoleProgress() { clear_line(); }

void ConsoleProgress::stage(std::string_view name) {
  if (quiet_) return;
  const std::scoped_lock lock(mutex_);
  clear_line();
  stage_ = name;
  stage_start_ = last_drawn_ = Clock::now();
  if (terminal_) {
    draw(0, stage_start_);
  } else {
    say(fmt::format("isopath: {}\n", stage_));
  }
}

void ConsoleProgress::at(double fraction) {
  if (quiet_) return;
  const std::scoped_lock lock(mutex_);
  const auto now = Clock::now();
  // A bar moves smoothly at ten frames a second; a log file wants a sign of life now and then.
  const auto pause = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10000);
  if (now - last_drawn_ < pause) return;
  last_drawn_ = now;
  draw(std::clamp(fraction, 0.0, 1.0), now);
}

bool ConsoleProgress::cancelled() const { return interrupted; }

void ConsoleProgress::draw(double fraction, Clock::time_point now) {
  const double elapsed = std::chrono::duration<double>(now - stage_start_).count();
  std::string left;
  if (fraction > 0.02 && elapsed > 1)
    left = fmt::format(", {} left", duration_text(elapsed * (1 - fraction) / fraction));
  if (!terminal_) {
    say(fmt::format("isopath: {}: {:.0f} %{}\n", stage_, 100 * fraction, left));
    return;
  }
  constexpr int width = 30;
  const int filled = static_cast<int>(width * fraction);
  say(fmt::format("\r\x1b[K{:<24} [{:=<{}}{:<{}}] {:3.0f} %{}", stage_, "", filled, "", width - filled, 100 * fraction,
                  left));
  line_open_ = true;
}

void ConsoleProgress::clear_line() {
  if (line_open_) say("\r\x1b[K");
  line_open_ = false;
}

void listen_for_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGHUP, &action, nullptr);
  // A file that outgrows its limit is an error to report, not a reason to end with half a folder written.
  action.sa_handler = SIG_IGN;
  ::sigaction(SIGXFSZ, &action, nullptr);
}

void print_warnings(const CommonFlags& flags, const std::vector<std::string>& warnings) {
  if (flags.quiet) return;
  for (const std::string& warning : warnings) say(fmt::format("isopath: warning: {}\n", warning));
}

void print(std::string_view text) {
  const bool good = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!good) throw Error(ErrorCode::bad_input, "cannot write to standard output");
}

void print_json(const nlohmann::ordered_json& json) {
  print(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

int run(const CommonFlags& flags, const Action& action) {
  try {
    std::optional<tbb::global_control> limit;
    if (flags.threads > 0) {
      limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(flags.threads));
    }
    action();
    return 0;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) {
      say("isopath: interrupted; nothing was written\n");
    } else if (error.code() == ErrorCode::internal) {
      report_fault(error.what());
    } else {
      say(fmt::format("isopath: error: {}\n", error.what()));
    }
    return status_of(error.code());
  } catch (const std::bad_alloc&) {
    say("isopath: error: out of memory\n  use a coarser mesh or a machine with more memory\n");
    return exit_fault;
  } catch (const std::exception& error) {
    report_fault(error.what());
    return exit_fault;
  }
}

}  // namespace isopath::app
