#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "studies/commands/command.h"
#include "studies/render_setup.h"

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

/// A line on a camera's case.
std::string in_words(std::string const& folder, nlohmann::ordered_json const& summary) {
  std::string text = fmt::format("{}: ", folder);
  if (summary.contains("planes")) text += fmt::format("{} planes, ", summary["planes"].size());
  bool const piv = summary.value("experiment", "") == "piv";
  text += fmt::format("{} {}, {} rays each, ", summary["dots"].get<long long>(), piv ? "particles" : "dots",
                      summary["rays_per_dot"].get<long long>());
  if (summary.contains("step_mm")) {
    text += fmt::format("step {:.4g} mm, magnification {:.6g}, ", summary["step_mm"].get<double>(),
                        summary["magnification"].get<double>());
  }
  return text +
         fmt::format("{:.2f} s on {}", summary["seconds_render"].get<double>(), summary["device"].get<std::string>());
}

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
    SetupRendering rendering(arguments->setup, arguments->overrides);
    rendering.refuse_over_inputs(arguments->folder);
    auto const renderer = options.open_device().renderer;
    std::string const summary = rendering.render(*renderer, arguments->folder);
    auto const json = nlohmann::ordered_json::parse(summary);
    std::string text;
    if (json.contains("cameras")) {
      for (auto const& [name, one] : json["cameras"].items()) {
        text += in_words((std::filesystem::path(arguments->folder) / name).string(), one) + '\n';
      }
    } else {
      text = in_words(arguments->folder, json);
    }
    print_result(options, summary, text);
    return ok;
  };
}

}  // namespace gladstone
