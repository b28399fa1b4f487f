#include "studies/figures/agreement_figure.h"

#include <cmath>
#include <string>

#include "render/base/contracts.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

constexpr double smallest = 0.2, largest = 10;

struct AgreementPanel {
  char const* title;
  double Agreement::*value;
  LegendPlace legend;
  double left, right;  ///< left and right edge on the page [px]
};
constexpr AgreementPanel agreement_panels[] = {
    {"correlation of light rays and Eq. 9", &Agreement::correlation, LegendPlace::bottom_right, 62, 522},
    {"rms of light rays / rms of Eq. 9", &Agreement::rms_ratio, LegendPlace::top_left, 604, 1064}};

Panel make_agreement_panel(AgreementPanel const& chosen, std::vector<AgreementSeries> const& series) {
  Panel panel{.box = {chosen.left, chosen.right, 42, 404}, .title = chosen.title};
  panel.x = {"size of structures / width of the light cone at the medium", smallest, largest, true};
  panel.x.ticks = logarithmic_ticks(smallest, largest);
  panel.y = {.low = 0, .high = 1.05};
  panel.legend.place = chosen.legend;
  panel.grid = Grid::both;
  for (std::size_t i = 0; i < series.size(); ++i) {
    Layer line{.columns = {{}, {}}, .colour = house_colour(i), .name = series[i].name + ": theory"};
    Layer rays{Layer::Kind::errors, {{}, {}, {}, {}}, line.colour, series[i].name + ": rays", 1.6};
    rays.marker = static_cast<int>(i) + 1;
    rays.size = 1.3;
    for (auto const& prediction : series[i].prediction) {
      line.columns[0].push_back(prediction.size_over_cone);
      line.columns[1].push_back(prediction.value.*chosen.value);
    }
    for (auto const& point : series[i].points) {
      double const x = point.size_over_cone, y = point.value.*chosen.value, error = point.error.*chosen.value;
      rays.columns[0].push_back(x);
      rays.columns[1].push_back(y);
      rays.columns[2].push_back(y - error);
      rays.columns[3].push_back(y + error);
      // labels are above one curve and below the other
      double const side = i == 0 ? -1 : 1;
      panel.labels.push_back(
          {std::to_string(point.nodes), x, y, TextRole::note, Align::centre, side * 15, side * 9, false, line.colour});
    }
    panel.layers.push_back(std::move(line));
    panel.layers.push_back(std::move(rays));
  }
  return panel;
}

}  // namespace

std::vector<double> agreement_sizes() {
  constexpr int steps = 100;
  std::vector<double> sizes;
  for (int i = 0; i <= steps; ++i) sizes.push_back(smallest * std::pow(largest / smallest, i / double(steps)));
  return sizes;
}

Figure make_agreement_figure(std::vector<AgreementSeries> const& series, std::vector<double> const& single_wave) {
  GLADSTONE_EXPECTS(!series.empty() && single_wave.size() == agreement_sizes().size());
  Figure figure{1080, 470};
  for (AgreementPanel const& panel : agreement_panels) figure.panels.push_back(make_agreement_panel(panel, series));
  Layer wave{.columns = {agreement_sizes(), single_wave}, .colour = "#808080", .name = "a single wave of that length"};
  wave.width = 1.5;
  wave.dash = Dash::dashed;
  std::vector<Layer>& layers = figure.panels.back().layers;
  layers.insert(layers.begin(), std::move(wave));
  return figure;
}

}  // namespace gladstone::inline figures
