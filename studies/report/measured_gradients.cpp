#include "studies/report/measured_gradients.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/drawing/draw_figure.h"
#include "studies/figures/map_panels.h"
#include "studies/report/case_view.h"

namespace gladstone {
namespace {

void add_map(nlohmann::json& fields, std::string const& name, std::string const& title, std::string const& unit,
             std::vector<Vec2d> const& values) {
  fields.push_back({{"name", name},
                    {"title", title},
                    {"unit", unit},
                    {"u", component_json(values, &Vec2d::x)},
                    {"v", component_json(values, &Vec2d::y)}});
}

}  // namespace

MeasuredGradients compute_gradients(DisplacementField const& field, DesignPoint<double> const& bench, double common) {
  MeasuredGradients all;
  all.common = common;
  double const per_px = 1 / bench.sensitivity(), formula = bench.random_error();
  for (std::size_t i = 0; i < field.size(); ++i) {
    bool const counts =
        field.counts(i) && std::isfinite(field.displacement_px[i].x) && std::isfinite(field.displacement_px[i].y);
    Vec2d const unknown{std::nan(""), std::nan("")};
    if (!counts) {
      all.gradient.push_back(unknown);
      all.random.push_back(unknown);
      all.combined.push_back(unknown);
      continue;
    }
    ++all.count;
    Vec2d sigma = field.sigma_px.empty() ? unknown : field.sigma_px[i];
    if (is_finite(sigma)) {
      ++all.estimated;
    } else {
      sigma = {formula, formula};
    }
    Vec2d const g = Vec2d{-field.displacement_px[i].x, field.displacement_px[i].y} * per_px;
    Vec2d const random = sigma * per_px;
    all.gradient.push_back(g);
    all.random.push_back(random);
    all.combined.push_back({std::hypot(random.x, common * g.x), std::hypot(random.y, common * g.y)});
  }
  return all;
}

std::vector<double> finite_components(std::vector<Vec2d> const& values) {
  std::vector<double> found;
  for (Vec2d const& value : values) {
    for (double const one : {value.x, value.y}) {
      if (std::isfinite(one)) found.push_back(one);
    }
  }
  return found;
}

double compute_rms(std::vector<double> const& values) {
  double sum = 0;
  for (double const value : values) sum += value * value;
  return values.empty() ? std::nan("") : std::sqrt(sum / static_cast<double>(values.size()));
}

nlohmann::json measured_maps(DisplacementField const& field, MeasuredGradients const& all) {
  nlohmann::json fields = nlohmann::json::array();
  add_map(fields, "measured", "measurement", "px", field.displacement_px);
  add_map(fields, "gradient", "density gradient, along X and Y", "kg/m^4", all.gradient);
  add_map(fields, "combined", "combined standard uncertainty of the gradient", "kg/m^4", all.combined);
  add_map(fields, "random", "contribution of the displacement to it", "kg/m^4", all.random);
  return fields;
}

std::string draw_measured_maps(std::string const& path, DisplacementField const& field, MeasuredGradients const& all) {
  MapFigure figure;
  figure.title = "Measured displacement, density gradient and its combined standard uncertainty";
  figure.axes.x_first = field.position_px.front().x;
  figure.axes.y_first = field.position_px.front().y;
  figure.axes.x_step = field.position_px[1].x - figure.axes.x_first;
  figure.axes.y_step = field.position_px[static_cast<std::size_t>(field.columns)].y - figure.axes.y_first;
  auto const add = [&](std::string const& title, std::vector<Vec2d> const& values, double Vec2d::*component,
                       ColourScale scale, std::string const& group) {
    Image<double> map(field.columns, field.rows);
    for (std::size_t i = 0; i < values.size(); ++i) map.data()[i] = values[i].*component;
    figure.panels.push_back({title, std::move(map), scale, group});
  };
  add("u [px]", field.displacement_px, &Vec2d::x, ColourScale::diverging, "displacement");
  add("v [px]", field.displacement_px, &Vec2d::y, ColourScale::diverging, "displacement");
  add("∂ρ/∂x [kg/m⁴]", all.gradient, &Vec2d::x, ColourScale::diverging, "gradient");
  add("∂ρ/∂y [kg/m⁴]", all.gradient, &Vec2d::y, ColourScale::diverging, "gradient");
  add("u_c of ∂ρ/∂x [kg/m⁴]", all.combined, &Vec2d::x, ColourScale::magnitude, "uncertainty");
  add("u_c of ∂ρ/∂y [kg/m⁴]", all.combined, &Vec2d::y, ColourScale::magnitude, "uncertainty");
  draw_figure(make_map_figure(figure), path);
  return path;
}

}  // namespace gladstone
