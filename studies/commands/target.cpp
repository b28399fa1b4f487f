#include "studies/commands/target.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/output_file.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/json_text.h"
#include "studies/case/target_pattern.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {
namespace {

constexpr Vec2d a3_mm{297, 420};  ///< shorter and longer side of the paper

/// Formats a pattern by the ending of the output's name.
std::string formatted_target(TargetPattern const& pattern, std::string const& path) {
  std::string const ending = std::filesystem::path(path).extension().string();
  if (ending == ".pdf") return target_pdf(pattern);
  if (ending == ".svg") return target_svg(pattern);
  if (ending == ".csv") return target_csv(pattern);
  throw OutputError(path, "is not the name of a pattern: it must end in .pdf, .svg or .csv");
}

}  // namespace

Description write_target(SetupDocument const& setup, std::string const& name, std::string const& output) {
  // All cameras of a setup see the same target.
  CaseSetup const loaded = std::move(load_cameras(setup).front().loaded);
  TargetPattern const pattern = make_target_pattern(loaded.setup, name);
  OutputFile::write_text(output, formatted_target(pattern, output));
  TargetPage const page = make_target_page(pattern);
  double const diameter_mm = pattern.diameter / unit::millimetre;
  Vec2d const extent = pattern.extent / unit::millimetre;
  nlohmann::ordered_json const json{{"output", output},
                                    {"dots", pattern.centre.size()},
                                    {"dot_diameter_mm", diameter_mm},
                                    {"extent_mm", {extent.x, extent.y}},
                                    {"page_mm", {page.size_mm.x, page.size_mm.y}},
                                    {"scale_bar_mm", page.scale_bar_mm}};
  bool const large =
      std::min(page.size_mm.x, page.size_mm.y) > a3_mm.x || std::max(page.size_mm.x, page.size_mm.y) > a3_mm.y;
  return {json_text(json),
          fmt::format("{}: {} dots of {:.6g} mm on {:.6g} x {:.6g} mm, page {:.6g} x {:.6g} mm{}, scale bar {:g} mm\n",
                      output, pattern.centre.size(), diameter_mm, extent.x, extent.y, page.size_mm.x, page.size_mm.y,
                      large ? " (larger than A3: for a plotter)" : "", page.scale_bar_mm)};
}

CommandBody attach_target(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string setup, output;
    std::vector<std::string> overrides;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("setup", arguments->setup, "Setup of a BOS experiment or a calibration (TOML)")->required();
  app.add_option("-o,--output", arguments->output,
                 "Pattern to create: .pdf or .svg at true scale with a scale bar, or .csv (x_mm,y_mm)")
      ->required();
  app.add_option("--set", arguments->overrides, "Override a key: --set target.dot_diameter_mm=0.5")
      ->take_all()
      ->expected(1)
      ->trigger_on_parse(false);
  return [arguments, &options] {
    SetupDocument const document = read_setup_document(arguments->setup, arguments->overrides);
    Description const written = write_target(document, arguments->setup, arguments->output);
    print_result(options, written.json, written.text);
    return ok;
  };
}

}  // namespace gladstone::inline commands
