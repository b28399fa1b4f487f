#pragma once

#include <functional>
#include <string>

#include "studies/case/backend.h"

namespace CLI {
class App;
}

namespace gladstone::inline commands {

/// Exit codes of the executable.
enum ExitCode : int {
  ok = 0,
  check_missed = 1,
  bad_input = 2,
  incomplete = 3,
  infeasible = 4,
  device_error = 5,
  interrupted_by_user = 130
};

/// Options common to all commands.
struct GlobalOptions {
  bool json = false;
  bool quiet = false;
  int threads = 0;
  std::string device = "auto";

  /// Opens the device of --device, see gladstone::open_device().
  Backend open_device() const { return gladstone::open_device(device); }
};

/// A command adds its options to its sub-application and returns the function to run, which returns the exit code.
using CommandBody = std::function<int()>;
struct Command {
  char const* name;
  char const* summary;
  char const* example;
  CommandBody (*attach)(CLI::App& app, GlobalOptions const& options);
};

CommandBody attach_init(CLI::App& app, GlobalOptions const& options);
CommandBody attach_keys(CLI::App& app, GlobalOptions const& options);
CommandBody attach_render(CLI::App& app, GlobalOptions const& options);
CommandBody attach_target(CLI::App& app, GlobalOptions const& options);
CommandBody attach_correlate(CLI::App& app, GlobalOptions const& options);
CommandBody attach_compare(CLI::App& app, GlobalOptions const& options);
CommandBody attach_convert(CLI::App& app, GlobalOptions const& options);
CommandBody attach_reconstruct(CLI::App& app, GlobalOptions const& options);
CommandBody attach_stereo(CLI::App& app, GlobalOptions const& options);
CommandBody attach_tomography(CLI::App& app, GlobalOptions const& options);
CommandBody attach_trace(CLI::App& app, GlobalOptions const& options);
CommandBody attach_info(CLI::App& app, GlobalOptions const& options);
CommandBody attach_validate(CLI::App& app, GlobalOptions const& options);
CommandBody attach_design(CLI::App& app, GlobalOptions const& options);
CommandBody attach_sweep(CLI::App& app, GlobalOptions const& options);
CommandBody attach_calibrate(CLI::App& app, GlobalOptions const& options);
CommandBody attach_views(CLI::App& app, GlobalOptions const& options);
CommandBody attach_demo(CLI::App& app, GlobalOptions const& options);
CommandBody attach_gallery(CLI::App& app, GlobalOptions const& options);
CommandBody attach_benchmark(CLI::App& app, GlobalOptions const& options);
CommandBody attach_report(CLI::App& app, GlobalOptions const& options);
CommandBody attach_completion(CLI::App& app, GlobalOptions const& options);

/// Sub-command of `gladstone sweep`.
CommandBody attach_sweep_run(CLI::App& app, GlobalOptions const& options);

/// Prints the result of a command. With --json, prints the JSON object including the warnings of the run, otherwise the
/// text.
void print_result(GlobalOptions const& options, std::string const& json, std::string const& text);

/// Prints a line on stderr and ignores errors, such as a closed or full stderr.
void print_error(std::string const& text);

}  // namespace gladstone::inline commands
