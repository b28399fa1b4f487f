#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/image.h"
#include "render/base/random_variates.h"
#include "render/base/units.h"
#include "render/base/vec.h"

namespace gladstone::test {

/// Dot of a synthetic image: a Gaussian integrated over pixels by the error function.
struct SyntheticDot {
  Vec2d centre;
  double height = 0;      ///< irradiance at the centre [grey levels]
  double sigma_x = 0.75;  ///< standard deviations [px]
  double sigma_y = 0.75;
};

/// Returns the light of a dot on a pixel [grey levels].
inline double light_on(SyntheticDot const& dot, int column, int row) {
  auto const share = [](double t, double sigma) {
    double const scale = std::sqrt(0.5) / sigma;
    return sigma * std::sqrt(0.5 * pi) * (std::erf((t + 0.5) * scale) - std::erf((t - 0.5) * scale));
  };
  return dot.height * share(column - dot.centre.x, dot.sigma_x) * share(row - dot.centre.y, dot.sigma_y);
}

/// Adds dots to an image; negative heights are dark dots.
inline void add_dots(Image<double>& image, std::vector<SyntheticDot> const& dots) {
  for (SyntheticDot const& dot : dots) {
    int const reach = static_cast<int>(6 * std::max(dot.sigma_x, dot.sigma_y)) + 2;
    int const x = static_cast<int>(std::lround(dot.centre.x)), y = static_cast<int>(std::lround(dot.centre.y));
    for (int row = std::max(0, y - reach); row <= std::min(image.rows() - 1, y + reach); ++row)
      for (int column = std::max(0, x - reach); column <= std::min(image.columns() - 1, x + reach); ++column)
        image(column, row) += light_on(dot, column, row);
  }
}

/// Returns an image of dots on a background, with normal noise, rounded to grey levels of 16 bits.
inline Image<double> dot_image(int side, std::vector<SyntheticDot> const& dots, double background, double noise,
                               KeyedEngine& random) {
  Image<double> image(side, side, background);
  add_dots(image, dots);
  for (double& level : image)
    level = std::clamp(std::floor(level + noise * normal_variate(random) + 0.5), 0.0, 65535.0);
  return image;
}

/// Returns random places in a square, no two of them closer than `apart`; fewer than `count` if they do not fit.
inline std::vector<Vec2d> random_places(std::size_t count, double side, double apart, KeyedEngine& random) {
  std::vector<Vec2d> places;
  for (int tries = 0; tries < 1000000 && places.size() < count; ++tries) {
    Vec2d const p{to_unit(random()) * side - 0.5, to_unit(random()) * side - 0.5};
    bool const free =
        apart <= 0 || std::none_of(places.begin(), places.end(), [&](Vec2d q) { return length(p - q) < apart; });
    if (free) places.push_back(p);
  }
  return places;
}

/// Frames A and B of moving dots.
struct MovedDots {
  Image<double> a, b;
};

/// Renders frames of dots that are at `places` in frame A and move by field(place) [px], with noise of 1 % of their
/// height.
template <class Field>
MovedDots moved_dots(int side, std::vector<Vec2d> const& places, Field const& field, KeyedEngine& random) {
  std::vector<SyntheticDot> a, b;
  for (Vec2d const p : places) {
    a.push_back({p, 40000});
    b.push_back({p + field(p), 40000});
  }
  MovedDots frames;
  frames.a = dot_image(side, a, 2500, 400, random);
  frames.b = dot_image(side, b, 2500, 400, random);
  return frames;
}

}  // namespace gladstone::test
