#include "studies/examples/gallery.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {

CommandBody attach_gallery(CLI::App& app, GlobalOptions const& options) {
  auto folder = std::make_shared<std::string>("out/gallery");
  app.add_option("-o,--output", *folder, "Folder for the cases, NAME/beside.png and gallery.png")
      ->capture_default_str();
  return [folder, &options] {
    std::string const text = run_gallery(*folder, options.open_device());
    print_result(options, json_text(nlohmann::json{{"folder", *folder}, {"pictures", text}}), text);
    return ok;
  };
}

}  // namespace gladstone::inline commands
