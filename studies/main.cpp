#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/nearest_name.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/files/input_guard.h"
#include "studies/case/backend.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/error_json.h"
#include "studies/commands/protected_files.h"
#include "studies/commands/run_warnings.h"

namespace gladstone {
namespace {

/// One row per command.
constexpr std::array commands{
    Command{"init", "Write a commented template of a setup, a study or a design problem",
            "gladstone init bos -o bos.toml && gladstone render bos.toml -o out/bos", attach_init},
    Command{"keys", "List the keys of setups with unit, default, allowed values and meaning", "gladstone keys f_number",
            attach_keys},
    Command{"render", "Render the image pair of a setup, or the planes of a calibration, into a case folder",
            "gladstone render table1.toml -o out/case", attach_render},
    Command{"target", "Write the dot pattern of a setup at true scale, for printing",
            "gladstone target table1.toml -o pattern.pdf", attach_target},
    Command{"correlate", "Measure the displacement between two frames, or in a sequence of frames",
            "gladstone correlate out/case", attach_correlate},
    Command{"compare", "Compare measured vectors with ray truth and theory", "gladstone compare out/case",
            attach_compare},
    Command{"convert", "Write vectors or true displacements in another format: NetCDF, MATLAB, Tecplot, VTK, CSV, HDF5",
            "gladstone convert out/case/vectors.h5 -o out/vectors.nc", attach_convert},
    Command{"reconstruct", "Convert the displacement of a BOS measurement to density and its uncertainty",
            "gladstone reconstruct out/case --reference left -o out/density.h5", attach_reconstruct},
    Command{"stereo", "Combine the vectors of two calibrated cameras to three components and their uncertainty",
            "gladstone stereo out/stereo/left out/stereo/right -o out/uvw.h5", attach_stereo},
    Command{"tomography", "Reconstruct the density of a volume from the displacement of 3 to 16 views",
            "gladstone tomography out/view_* --reference left -o out/volume.h5", attach_tomography},
    Command{"trace", "Trace given rays and report where and why they end",
            "gladstone trace table1.toml --rays rays.csv -o out.csv", attach_trace},
    Command{"info", "Describe a setup, its particles, a field, an image, a lens or a sphere",
            "gladstone info field slice.h5", attach_info},
    Command{"design", "Predict what a set-up measures, or recommend one that meets requirements",
            "gladstone design table1.toml --figures out/design", attach_design},
    Command{"validate", "Compare results with exact solutions", "gladstone validate", attach_validate},
    Command{"calibrate", "Fit cameras to the dots of a calibration case, or of your own images",
            "gladstone calibrate out/calibration", attach_calibrate},
    Command{"views", "Extract the views of a plenoptic image, and refocus it",
            "gladstone views out/plenoptic --refocus 4", attach_views},
    Command{"sweep", "Parameter studies: plan, run, status, collect",
            "gladstone sweep plan study.toml -o run && gladstone sweep run run --jobs 2 && gladstone sweep collect run",
            attach_sweep},
    Command{"report", "Write a report on a study, a case or a measurement as one file, with charts and all settings",
            "gladstone report out/run -o report.html", attach_report},
    Command{"benchmark", "Score displacement estimators, ours and yours, on published cases",
            "gladstone benchmark -o out/benchmark --vectors mine=my_vectors", attach_benchmark},
    Command{"demo", "Run the experiment of Rajendran et al. (2019), from setup to error report",
            "gladstone demo -o out/demo", attach_demo},
    Command{"gallery", "Render normal and degraded particle images", "gladstone gallery -o out/gallery",
            attach_gallery},
    Command{"completion", "Print a script that completes command lines in bash, zsh or fish, or the manual page",
            "source <(gladstone completion bash)", attach_completion},
};

/// Reports a command line that names no command or contains unknown arguments.
int refuse_arguments(std::vector<std::string> const& unknown, CLI::App const* command, CLI::App const& app, bool json) {
  std::vector<std::string> known;
  for (Command const& one : commands) known.emplace_back(one.name);
  std::string const name = unknown.empty() ? "" : unknown.front();
  std::string path = command ? command->get_name() + ' ' : "";
  while (command && !command->get_subcommands().empty()) {  // descend into subcommands
    command = command->get_subcommands().front();
    path += command->get_name() + ' ';
  }
  bool chooses = !command;  // a subcommand is missing
  if (command) {
    known.clear();
    for (CLI::App const* one : command->get_subcommands([](CLI::App const*) { return true; })) {
      known.push_back(one->get_name());
    }
    chooses = !known.empty();
  }
  bool const is_option = name.starts_with('-');
  std::string message = "no command is given";
  if (!unknown.empty())
    message = fmt::format("unknown {} \"{}\"", is_option ? "option" : chooses ? "command" : "argument", name);
  if (is_option) {
    known = {"--help", "--version", "--json", "--quiet", "--threads", "--device"};
    for (CLI::Option const* option : (command ? command : &app)->get_options()) {
      for (std::string const& longer : option->get_lnames()) known.push_back("--" + longer);
    }
  }
  if (auto const nearest = nearest_name(name, known); nearest && (is_option || chooses)) {
    message += "; did you mean \"" + *nearest + "\"?";
  } else if (chooses && !is_option) {
    message += "; commands are " + quoted_list(known);
  }
  print_error(
      fmt::format("gladstone: {} See gladstone {}--help", message.ends_with('?') ? message : message + '.', path));
  if (json) fmt::print("{}\n", json_text(argument_error_json(name, message, bad_input)));
  return bad_input;
}

/// Returns true if the arguments contain --json, for command lines that are not parsed to the end.
bool wants_json(int argc, char** argv) {
  return std::find(argv + 1, argv + argc, std::string_view("--json")) != argv + argc;
}

/// Parses the arguments into `options` and runs the command. @return exit code
int run(int argc, char** argv, GlobalOptions& options) {
  CLI::App app{"gladstone: ray-traced synthetic BOS and PIV images, correlation and error analysis"};
  app.set_version_flag("--version", version_text(), "Print the version and the backends compiled in");
  app.fallthrough();
  app.require_subcommand(0, 1);
  app.add_flag("--json", options.json, "Print one JSON object and nothing else on stdout");
  app.add_flag("--quiet", options.quiet,
               "Suppress information and progress bars on stderr, but not warnings and errors");
  app.add_option("--threads", options.threads, "Threads to use; 0: all cores")->check(whole_number(0, 4096));
  app.add_option("--device", options.device, "auto, cpu or cuda")->check(one_of({"auto", "cpu", "cuda"}));
  app.footer(
      "Exit codes: 0 success, 1 a check failed, 2 invalid input or an output that cannot be written, 3 incomplete "
      "study, 4 no feasible design, 5 device error, 130 interrupted.");
  std::array<CommandBody, commands.size()> bodies;
  std::array<CLI::App*, commands.size()> parsed{};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    parsed[i] = app.add_subcommand(commands[i].name, commands[i].summary);
    parsed[i]->footer(
        fmt::format("Example:\n  {}\n\nGlobal options (--json --quiet --threads N --device D) may be placed anywhere.",
                    commands[i].example));
    bodies[i] = commands[i].attach(*parsed[i], options);
  }
  app.failure_message(refusal);
  app.allow_extras();  // unknown arguments are rejected below, with the nearest name
  try {
    app.parse(argc, argv);
  } catch (CLI::CallForVersion const&) {
    options.json = wants_json(argc, argv);  // parsing ends at --version, but --json may be before or after it
    print_result(options, version_json(), version_text());
    return ok;
  } catch (CLI::ParseError const& error) {
    if (app.exit(error) == 0) return ok;
    if (wants_json(argc, argv))
      fmt::print("{}\n", json_text(argument_error_json(find_argument(error), describe_problem(error), bad_input)));
    return bad_input;
  }
  auto const parsed_one =
      std::find_if(parsed.begin(), parsed.end(), [](CLI::App* command) { return command->parsed(); });
  if (std::vector<std::string> const unknown = app.remaining(true); !unknown.empty() || parsed_one == parsed.end()) {
    return refuse_arguments(unknown, parsed_one == parsed.end() ? nullptr : *parsed_one, app, options.json);
  }
  if (options.quiet) spdlog::set_level(spdlog::level::warn);
  Progress::enable(!options.quiet);
  set_thread_count(options.threads);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (parsed[i]->parsed()) return bodies[i]();
  }
  return bad_input;
}

/// Returns the exit code of an error other than those of devices and interruptions.
int exit_code(std::exception const& error) {
  auto const* const own = dynamic_cast<Error const*>(&error);
  return own && own->code() == ErrorCode::no_valid_vector ? check_missed : bad_input;
}

/// Runs the program and reports exceptions. @return exit code
int guarded(int argc, char** argv) {
  GlobalOptions options;
  auto const fail = [&](std::exception const& error, std::string const& message, int code) {
    print_error(message);
    if (options.json) {
      try {
        std::cout << json_text(error_json(error, code)) << '\n';
      } catch (std::exception const&) {
        // The message is on stderr already; main() reports output that is lost.
      }
    }
    return code;
  };
  try {
    return run(argc, argv, options);
  } catch (SetupError const& error) {
    return fail(error, error.what(), bad_input);
  } catch (Interrupted const& error) {
    return fail(error, fmt::format("gladstone: {}", error.what()), interrupted_by_user);
  } catch (DeviceError const& error) {
    return fail(error, fmt::format("gladstone: device error: {}", error.what()), device_error);
  } catch (std::exception const& error) {
    return fail(error, fmt::format("gladstone: {}", format_user_message(error)), exit_code(error));
  }
}

/// Opens stdin, stdout and stderr on /dev/null if the caller closed them, so that no file of the command receives
/// such a descriptor and collects messages. Reading and writing there fail.
void occupy_closed_streams() {
  for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) ::_exit(bad_input);
  }
}

/// Returns true if all output was written.
bool is_printed() {
  std::cout.flush();
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
}

}  // namespace
}  // namespace gladstone

int main(int argc, char** argv) {
  gladstone::occupy_closed_streams();
  spdlog::set_default_logger(spdlog::stderr_color_mt("gladstone"));
  spdlog::set_pattern("%^%l:%$ %v");
  gladstone::record_warnings(*spdlog::default_logger());
  gladstone::catch_interrupts();
  gladstone::InputGuard const guard(gladstone::protected_files());
  int const code = gladstone::guarded(argc, argv);
  if (!gladstone::is_printed()) {
    gladstone::print_error(
        "gladstone: cannot write to standard output, so that the result is lost; free some space there, or redirect "
        "the output");
    return gladstone::bad_input;
  }
  return code;
}
