#include "studies/report/density_section.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "render/base/not_a_number.h"
#include "studies/compare/density_file.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/density_figure.h"

namespace gladstone::inline report {
namespace {

/// Returns a number of the summary; NaN for null.
double number_at(nlohmann::ordered_json const& summary, char const* group, char const* name) {
  nlohmann::ordered_json const& value = summary[group][name];
  return value.is_number() ? value.get<double>() : not_a_number;
}

TextTable numbers_table(nlohmann::ordered_json const& summary) {
  TextTable table{"Numbers of the density [kg/m^3]", {"quantity", "least", "median", "largest"}, {}};
  for (auto const& [group, name] : {std::pair{"density_kg_m3", "density"},
                                    {"sigma_kg_m3", "standard uncertainty"},
                                    {"sigma_random_kg_m3", "standard uncertainty due to the vectors"}}) {
    table.rows.push_back({{name},
                          TableCell::of(number_at(summary, group, "least")),
                          TableCell::of(number_at(summary, group, "median")),
                          TableCell::of(number_at(summary, group, "largest"))});
  }
  return table;
}

TextTable density_budget_table(std::vector<DensityTerm> const& budget) {
  TextTable table{"Error budget of the density [kg/m^3]; the terms correlate, so that their squares do not add up",
                  {"cause", "bias", "rms"},
                  {}};
  for (DensityTerm const& term : budget)
    table.rows.push_back({{term.name}, TableCell::of(term.bias), TableCell::of(term.rms)});
  return table;
}

}  // namespace

std::string summarize_density(Reconstruction const& reconstruction) {
  nlohmann::ordered_json const summary = summarize_reconstruction(reconstruction);
  std::string text = fmt::format(
      "The density is {:.5g} to {:.5g} kg/m^3 at {} of {} x {} nodes, relative to the reference of {:.5g} kg/m^3",
      number_at(summary, "density_kg_m3", "least"), number_at(summary, "density_kg_m3", "largest"),
      summary["determined"].get<std::size_t>(), reconstruction.grid.columns, reconstruction.grid.rows,
      reconstruction.reference_density);
  text += summary["sigma_kg_m3"]["median"].is_number()
              ? fmt::format("; its standard uncertainty is {:.3g} kg/m^3 in the median and at most {:.3g} kg/m^3.",
                            number_at(summary, "sigma_kg_m3", "median"), number_at(summary, "sigma_kg_m3", "largest"))
              : std::string("; its uncertainty is unknown, since the vectors have none.");
  if (reconstruction.truth.empty()) return text;
  DensityErrors const errors = compute_density_errors(reconstruction);
  return text + fmt::format(
                    " Its error against the true density is {:.3g} kg/m^3 rms with a bias of {:.3g} kg/m^3; the true "
                    "density varies by {:.3g} kg/m^3 (standard deviation).",
                    errors.rms, errors.bias, errors.contrast);
}

ReportSection density_section(ReportPage& page, Reconstruction const& reconstruction) {
  nlohmann::ordered_json const summary = summarize_reconstruction(reconstruction);
  page.data["density"] = summary.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string const words = summarize_density(reconstruction);
  ReportSection section{"Density", {Paragraph{words}}};
  section.blocks.emplace_back(
      Chart{"density", "Maps of the density", words, {{"", make_density_figure(reconstruction)}}});
  section.blocks.emplace_back(Chart{"density_profile",
                                    "Profile of the density",
                                    describe_density_profile(reconstruction),
                                    {{"", make_density_profile(reconstruction)}}});
  section.blocks.emplace_back(numbers_table(summary));
  if (!reconstruction.budget.empty()) section.blocks.emplace_back(density_budget_table(reconstruction.budget));
  if (!reconstruction.warnings.empty()) section.blocks.emplace_back(TextList{to_strings(reconstruction.warnings)});
  return section;
}

ReportSection missing_density_section(std::string const& command) {
  return {"Density",
          {Paragraph{fmt::format("No density was reconstructed, since no reference region was given. The command \"{} "
                                 "--reference left\" adds the density relative to that at the left side of the image; "
                                 "choose a side or a box where the density is known.",
                                 command)}}};
}

std::vector<std::string> draw_density_figures(std::string const& folder, std::string const& format,
                                              Reconstruction const& reconstruction) {
  std::vector<std::string> const drawn{folder + "/density." + format, folder + "/density_profile." + format};
  draw_figure(make_density_figure(reconstruction), drawn.front());
  draw_figure(make_density_profile(reconstruction), drawn.back());
  return drawn;
}

}  // namespace gladstone::inline report
