#include "studies/commands/info_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/design/setup_overview.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/layout_figure.h"
#include "studies/report/layout_view.h"

namespace gladstone::inline commands {
namespace {

/// Returns the figure's name for one of several cameras.
std::string figure_of_camera(std::string const& figure, std::string const& camera) {
  if (camera.empty()) return figure;
  std::filesystem::path path = figure;
  path.replace_filename(path.stem().string() + '_' + camera + path.extension().string());
  return path.string();
}

/// Draws the layout of a camera. @return false without gnuplot
bool draw_setup(std::string const& path, CaseSetup loaded) {
  Setup const setup = loaded.setup;
  return draw_or_warn([&] {
    auto const view = layout_view(std::move(loaded));
    draw_figure(view ? make_view_figure(*view) : make_camera_layout_figure(setup), path);
  });
}

}  // namespace

Description describe_setup(SetupDocument const& setup, std::string const& name, std::string const& figure) {
  std::string text;
  std::vector<ResultRow> rows;
  nlohmann::ordered_json cameras = nlohmann::ordered_json::object(), only;
  Warnings warned;  // several cameras may have the same warnings
  auto const warn_once = [&warned](Warnings const& warnings) {
    for (Warning const& warning : warnings) {
      if (std::find(warned.begin(), warned.end(), warning) != warned.end()) continue;
      log_warning(warned.emplace_back(warning));
    }
  };
  for (auto const& [camera, loaded] : load_cameras(setup)) {
    std::string const path = figure_of_camera(figure, camera);
    warn_once(loaded.warnings);
    warn_once(list_neglected_effects(loaded.setup));
    SetupOverview const overview = make_setup_overview(loaded.copy());
    only = overview_json(overview);
    text += fmt::format("{}{}: {}\n{}", name, camera.empty() ? "" : ", camera " + camera, overview.experiment,
                        overview_text(overview));
    if (!figure.empty() && draw_setup(path, loaded.copy())) {
      only["figure"] = path;
      text += fmt::format("  figure: {}\n", path);
    }
    append_rows(rows, overview.rows, camera);
    if (!camera.empty()) cameras[camera] = only;
  }
  if (figure.empty()) text += fmt::format("to draw the layout: gladstone info setup {} --figure layout.png\n", name);
  nlohmann::ordered_json const json = cameras.empty() ? only : nlohmann::ordered_json{{"cameras", cameras}};
  return {json_text(json), text, std::move(rows)};
}

}  // namespace gladstone::inline commands
