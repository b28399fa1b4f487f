#include "studies/figures/sequence_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "render/base/contracts.h"
#include "render/base/text.h"
#include "studies/figures/map_panels.h"

namespace gladstone::inline figures {
namespace {

Image<double> make_map(SequenceMoments const& moments, std::vector<Vec2d> const& values, double Vec2d::*component) {
  Image<double> map(moments.columns, moments.rows);
  std::transform(values.begin(), values.end(), map.begin(), [component](Vec2d value) { return value.*component; });
  return map;
}

}  // namespace

Figure make_sequence_figure(SequenceMoments const& moments) {
  GLADSTONE_EXPECTS(moments.columns > 0 && moments.rows > 0);
  auto const columns = static_cast<std::size_t>(moments.columns);
  auto const step = [&](std::size_t next, double Vec2d::*axis) {
    std::vector<Vec2d> const& position = moments.position_px;
    return next < position.size() ? position[next].*axis - position[0].*axis : 1.0;
  };
  MapFigure figure;
  figure.title =
      fmt::format("Mean and standard deviation of the displacement over {}", count_text(moments.samples, "pair"));
  figure.axes = {moments.position_px[0].x, columns > 1 ? step(1, &Vec2d::x) : 1.0, moments.position_px[0].y,
                 step(columns, &Vec2d::y)};
  for (auto const& [name, component] : {std::pair("u", &Vec2d::x), std::pair("v", &Vec2d::y)}) {
    figure.panels.push_back({fmt::format("mean of {} [px]", name), make_map(moments, moments.mean_px, component)});
    figure.panels.push_back({fmt::format("standard deviation of {} [px]", name),
                             make_map(moments, moments.rms_px, component), ColourScale::magnitude,
                             "standard deviation"});
  }
  return make_map_figure(figure);
}

}  // namespace gladstone::inline figures
