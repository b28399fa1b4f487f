#include "render/focused_dots/moment_images.h"

#include <algorithm>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr int orders = DisplacementMoments::order + 1, most_lanes = 48;

/// Numbers in which a spot's row is held: whole vectors, whose ends add zeros beyond its last pixel.
int lanes_for(int reach) { return reach <= 8 ? 8 : (reach <= 16 ? 16 : most_lanes); }

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
    throw_if_interrupted();
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

MomentImages MomentImages::plan(double half_px, GaussianSpot<double> const& spot, double side, int terms) {
  constexpr std::size_t most_bytes = std::size_t{64} << 20;
  MomentImages images;
  images.lattice = MomentLattice::no_coarser(side);
  // the source's points lie up to half a pixel further out than seen from the pixel's middle, spots about their pixels
  images.half = static_cast<int>(std::ceil(half_px + 0.5 + MomentLattice::aside)) + spot.half_width();
  images.terms = terms;
  int const reach = 2 * spot.half_width() + 1;
  if (reach > most_lanes || !(half_px < 1000)) return {};
  images.stride = (images.width() * images.width() + lanes_for(reach) - reach + pad - 1) / pad * pad;
  return images.size() * sizeof(double) <= most_bytes ? images : MomentImages{};
}

std::vector<double> make_moment_images(MomentImages const& plan, std::vector<Vec2d> const& points,
                                       std::vector<double> const& weights, double half_px,
                                       GaussianSpot<double> const& spot) {
  std::vector<double> values(plan.size());
  MomentImages images = plan;
  images.values = values.data();
  parallel_for(static_cast<std::size_t>(images.phases()), [&](std::size_t k) {
    auto const phase = static_cast<int>(k);
    double* const first = values.data() + (images.of_phase(phase) - images.values);
    auto const make = [&]<int lanes>() {
      make_images<lanes>(images, first, images.middle(phase), points, weights, half_px, spot);
    };
    switch (lanes_for(2 * spot.half_width() + 1)) {
      case 8:
        make.operator()<8>();
        break;
      case 16:
        make.operator()<16>();
        break;
      default:
        make.operator()<most_lanes>();
    }
  });
  return values;
}

}  // namespace gladstone
