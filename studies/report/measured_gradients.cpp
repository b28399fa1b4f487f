#include "studies/report/measured_gradients.h"

#include <cmath>

#include "studies/drawing/draw_figure.h"
#include "studies/figures/map_figures.h"

namespace gladstone::inline report {
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

std::vector<NamedFigure> make_measured_maps(DisplacementField const& field, MeasuredGradients const& all) {
  return {{"measurement", make_vector_maps(field, field.displacement_px, "px")},
          {"density gradient, along X and Y", make_vector_maps(field, all.gradient, "kg/m^4")},
          {"combined standard uncertainty of the gradient", make_vector_maps(field, all.combined, "kg/m^4")},
          {"contribution of the displacement to it", make_vector_maps(field, all.random, "kg/m^4")}};
}

std::string draw_measured_maps(std::string const& path, DisplacementField const& field, MeasuredGradients const& all) {
  MapFigure figure{.title = "Measured displacement, density gradient and its combined standard uncertainty",
                   .axes = lattice_axes(field)};
  auto const add = [&](std::string const& title, std::vector<Vec2d> const& values, double Vec2d::*component,
                       ColourScale scale, std::string const& group) {
    figure.panels.push_back({title, component_map(field, values, component), scale, group});
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

}  // namespace gladstone::inline report
