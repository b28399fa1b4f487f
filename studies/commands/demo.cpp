#include "studies/examples/demo.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {

CommandBody attach_demo(CLI::App& app, GlobalOptions const& options) {
  auto folder = std::make_shared<std::string>("out/demo");
  app.add_option("-o,--output", *folder, "Folder for the cases, figure4.png, agreement.png and summary.md")
      ->capture_default_str();
  return [folder, &options] {
    std::string const summary = run_demo(*folder, options.open_device());
    print_result(options, json_text(nlohmann::json{{"folder", *folder}, {"summary", summary}}), summary);
    return ok;
  };
}

}  // namespace gladstone::inline commands
