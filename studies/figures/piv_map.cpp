#include "studies/figures/piv_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "studies/case/expected_particles.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

constexpr std::array<double, 10> piv_f_numbers{1.4, 2, 2.8, 4, 5.6, 8, 11, 16, 22, 32};
constexpr double most_image_px = 4;  // maximum diameter of row F14 of the design sheet

}  // namespace

std::vector<PivStop> piv_stops(Setup setup) {
  std::vector<PivStop> rows;
  for (double const stop : piv_f_numbers) {
    setup.lens.f_number = stop;
    ExpectedParticles const expected = expected_particles(setup);
    SizeSpread const& peak = expected.peak_electrons;
    rows.push_back(
        {stop, expected.image_diameter_px, expected.sheet_edge_diameter_px, {peak.p05, peak.median, peak.p95}});
  }
  return rows;
}

Figure make_piv_map(Setup const& setup) {
  std::vector<double> f_number, image, edge, low, median, high;
  for (PivStop const& row : piv_stops(setup)) {
    f_number.push_back(row.f_number);
    image.push_back(row.image_px);
    edge.push_back(row.edge_px);
    low.push_back(row.peak_electrons[0]);
    median.push_back(row.peak_electrons[1]);
    high.push_back(row.peak_electrons[2]);
  }
  Panel images{.box = {92, 876, 72, 372}, .grid = Grid::both};
  images.x = {.low = piv_f_numbers.front() / 1.05, .high = piv_f_numbers.back() * 1.05, .logarithmic = true};
  for (double const stop : piv_f_numbers) images.x.ticks.push_back({stop, fmt::format("f/{:g}", stop)});
  std::vector<double> const across{images.x.low, images.x.high};
  Layer const own_stop{Layer::Kind::guides, {{setup.lens.f_number}}, house_colour(1), "", 2, Dash::dashed};
  auto const curve = [&](std::vector<double> const& y, std::size_t colour, char const* name) {
    return Layer{.columns = {f_number, y}, .colour = house_colour(colour), .name = name, .marker = 1};
  };
  Panel peaks = images;

  images.y = {"e⁻² diameter of an image [px]", std::min(1.0, 0.9 * *std::min_element(image.begin(), image.end())),
              std::max(5.0, 1.2 * *std::max_element(edge.begin(), edge.end())), true};
  for (double const at : {0.5, 1., 2., 3., 4., 5., 7., 10., 15., 20., 30., 50.})
    images.y.ticks.push_back({at, fmt::format("{:g}", at)});
  images.legend = {LegendPlace::above, 46, true};
  Layer const suitable{Layer::Kind::band,
                       {across, {min_image_px, min_image_px}, {most_image_px, most_image_px}},
                       "#d8ecd8",
                       "suitable for correlation, 2 to 4 px"};
  images.layers = {suitable, curve(image, 0, "in the middle of the sheet"), curve(edge, 2, "at its edge"), own_stop};
  images.layers[2].dash = Dash::dotted;

  double const well = setup.camera.noise.full_well_e;
  peaks.box = {92, 876, 412, 708};
  peaks.x.label = fmt::format("f-number; the setup has f/{:g}", setup.lens.f_number);
  peaks.y = {.label = "electrons at the peak", .logarithmic = true};
  peaks.legend.place = LegendPlace::bottom_left;
  Layer const most_particles{Layer::Kind::band, {f_number, low, high}, house_colour(0), "90 % of the particles"};
  peaks.layers = {
      most_particles,
      curve(median, 0, "the median particle"),
      {.columns = {across, {well, well}}, .colour = house_colour(3), .name = fmt::format("full well, {:.6g}", well)},
      own_stop};
  peaks.layers.front().opacity = 0.2;
  Figure figure{900, 760};
  figure.add_title("Particle images against the f-number");
  figure.panels = {std::move(images), std::move(peaks)};
  return figure;
}

}  // namespace gladstone::inline figures
