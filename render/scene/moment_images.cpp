#include "render/scene/moment_images.h"

#include <algorithm>

#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr int orders = DisplacementMoments::order + 1;

/// Adds one point of a source to all images of a phase.
/// @param corner in the first of them, of the spot's pixels @param shares [order][lanes], beyond the spot zero
/// @param lanes that the compiler knows, so that a row of the spot takes whole vectors
template <int lanes>
void add_point(MomentImages const& images, double* corner, int rows_of_spot, double weight, Vec2d place,
               double const* column_shares, double const* row_shares) {
  int const width = images.width();
  double basis[PlaceRule::terms];
  PlaceRule::basis(place, basis);
  for (int a = 0; a < orders; ++a) {
    double column[lanes];
    std::copy_n(column_shares + a * lanes, lanes, column);
    for (int b = 0; a + b < orders; ++b) {
      double* image = corner + DisplacementMoments::at(a, b) * images.terms * images.stride;
      for (int term = 0; term < images.terms; ++term, image += images.stride) {
        for (int row = 0; row < rows_of_spot; ++row) {
          double const share = weight * basis[term] * row_shares[b * lanes + row];
          double* const line = image + row * width;
          for (int i = 0; i < lanes; ++i) line[i] += share * column[i];
        }
      }
    }
  }
}

/// Makes the images of a phase, which are zero so far.
template <int lanes>
void make_images(MomentImages const& images, double* first, Vec2d middle, std::vector<Vec2d> const& points,
                 std::vector<double> const& weights, double half_px, GaussianSpot<double> const& spot) {
  int const reach = 2 * spot.half_width() + 1;
  std::vector<double> narrow(static_cast<std::size_t>(orders * reach));
  auto const pad = [&](double(&shares)[orders * lanes]) {
    for (int k = 0; k < orders; ++k) std::copy_n(narrow.data() + k * reach, reach, shares + k * lanes);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec2d const at = middle + half_px * points[i];
    Footprint const here = spot.footprint(at);
    double columns[orders * lanes] = {}, rows[orders * lanes] = {};
    spot.taylor_shares(at.x, here.column, reach, orders - 1, narrow.data());
    pad(columns);
    spot.taylor_shares(at.y, here.row, reach, orders - 1, narrow.data());
    pad(rows);
    double* const corner = first + (here.row + images.half) * images.width() + here.column + images.half;
    add_point<lanes>(images, corner, reach, weights[i], points[i], columns, rows);
  }
}

}  // namespace

OwnedMomentImages::OwnedMomentImages(std::vector<Vec2d> const& points, std::vector<double> const& weights,
                                     double half_px, GaussianSpot<double> const& spot, double side, int terms) {
  images_.lattice = BoxLattice::no_coarser(side);
  // the source's points lie up to half a pixel further out than seen from the pixel's middle, spots about their pixels
  images_.half = static_cast<int>(std::ceil(half_px + 0.5 + BoxLattice::aside)) + spot.half_width();
  int const width = images_.width(), reach = 2 * spot.half_width() + 1;
  // and a spot's rows in whole vectors, whose ends add zeros beyond its last pixel
  int const lanes = reach <= 8 ? 8 : (reach <= 16 ? 16 : 48);
  images_.stride = (width * width + lanes - reach + MomentImages::pad - 1) / MomentImages::pad * MomentImages::pad;
  images_.terms = terms;
  if (reach > 48 || images_.size() * sizeof(double) > most_bytes) {
    images_ = {};
    return;
  }
  values_.assign(images_.size(), 0.0);
  int const per_pixel = images_.lattice.per_pixel;
  parallel_for(static_cast<std::size_t>(images_.phases()), [&](std::size_t k) {
    int const phase = static_cast<int>(k);
    double* const first = values_.data() + (images_.of_phase(phase) - images_.values);
    Vec2d const middle{images_.lattice.offset(phase % per_pixel), images_.lattice.offset(phase / per_pixel)};
    auto const make = [&]<int known>() { make_images<known>(images_, first, middle, points, weights, half_px, spot); };
    if (lanes == 8) {
      make.operator()<8>();
    } else if (lanes == 16) {
      make.operator()<16>();
    } else {
      make.operator()<48>();
    }
  });
}

MomentImages OwnedMomentImages::view() const {
  MomentImages images = images_;
  images.values = values_.data();
  return images;
}

}  // namespace gladstone
