#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "studies/case.h"
#include "studies/commands/command.h"

namespace gladstone {
namespace {

constexpr char const* example_setup =
    R"(A setup to begin with. What is left out has a default; the setup.toml of the case has them all.

  [lens]
  focal_length_mm = 105.0
  f_number = 11.0

  [geometry]
  z_a_mm = 750.0       # from the lens to the middle of the medium
  z_d_mm = 250.0       # from there to the dots

  [medium.field]
  kind = "uniform_gradient"
  gradient_kg_m4 = [20.0, 10.0, 0.0])";

}  // namespace

CommandBody attach_render(CLI::App& app, GlobalOptions const& options) {
  app.footer(app.get_footer() + "\n\n" + example_setup);
  struct Arguments {
    std::string setup, folder;
    std::vector<std::string> overrides;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("setup", arguments->setup, "Setup file (TOML)")->required();
  app.add_option("-o,--output", arguments->folder, "Case folder to make")->required();
  app.add_option("--set", arguments->overrides, "Override a key: --set lens.f_number=16")
      ->take_all()
      ->expected(1)
      ->trigger_on_parse(false);
  return [arguments, &options] {
    CaseSetup loaded = load_case_setup(arguments->setup, arguments->overrides);
    std::vector<std::string> inputs = loaded.document.file_names();
    inputs.push_back(arguments->setup);
    refuse_case_over_inputs(arguments->folder, inputs);
    auto const renderer = options.open_device().renderer;
    std::string const summary = render_to_folder(loaded, *renderer, arguments->folder).summary;
    auto const json = nlohmann::json::parse(summary);
    print_result(options, summary,
                 fmt::format("{}: {} dots, {} rays each, step {:.4g} mm, magnification {:.6g}, {:.2f} s on {}",
                             arguments->folder, json["dots"].get<long long>(), json["rays_per_dot"].get<long long>(),
                             json["step_mm"].get<double>(), json["magnification"].get<double>(),
                             json["seconds_render"].get<double>(), json["device"].get<std::string>()));
    return ok;
  };
}

}  // namespace gladstone
