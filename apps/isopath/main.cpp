#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"

namespace {

std::string failure_message(const CLI::App* app, const CLI::Error& error) {
  const std::vector<std::string> unknown = app->remaining();
  if (app->get_subcommands().empty() && !unknown.empty()) {
    return fmt::format("isopath: error: there is no command '{}'\n  'isopath --help' lists them\n", unknown.front());
  }
  if (app->get_subcommands().empty() && dynamic_cast<const CLI::RequiredError*>(&error)) {
    return "isopath: error: no command was given\n  'isopath --help' lists them; start with 'isopath plan part.stl -o "
           "out'\n";
  }
  std::string command = "isopath";
  for (const CLI::App* parsed : app->get_subcommands()) command += " " + parsed->get_name();
  for (const std::string& argument : app->remaining(true)) {
    if (!argument.starts_with('-')) continue;  // the value of an unknown option is left over, too
    return fmt::format("isopath: error: there is no option '{}'\n  '{} --help' lists them\n", argument, command);
  }
  return fmt::format("isopath: error: {}\n  '{} --help' tells what is allowed\n", error.what(), command);
}

/// Every stage of a plan takes arrays of some megabytes and gives them back: to have the system clear the same pages
/// anew each time costs a twentieth of the whole. They stay with the process instead.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  using namespace isopath::app;
  CLI::App app(
      "isopath plans tool paths on free-form surfaces: a distance field on the part, its isolines, one curve through\n"
      "them, and the tool's path.\n");
  app.name("isopath");
  app.set_version_flag("--version", "isopath " ISOPATH_VERSION);
  app.footer(
      "Start with:\n"
      "  isopath check part.stl                 is the mesh fit for planning?\n"
      "  isopath plan part.stl -o out           plan a path; look at out/report.html\n"
      "'isopath COMMAND --help' explains a command with examples.\n"
      "Exit status: 0 done, 2 wrong usage, 3 bad input, 4 no plan possible, 130 interrupted, 1 a fault of isopath.");
  app.require_subcommand(1);
  app.failure_message(failure_message);

  keep_freed_memory();
  listen_for_interrupts();
  CommonFlags flags;
  Action action;
  add_plan(app, flags, action);
  add_check(app, flags, action);
  add_field(app, flags, action);
  add_contours(app, flags, action);
  add_medial_axis(app, flags, action);
  add_export(app, flags, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    constexpr int wrong_usage = 2;
    return app.exit(error) == 0 ? 0 : wrong_usage;
  }
  return run(flags, action);
}
