#include "render/focused_dots/moment_images.h"

#include "render/base/parallel.h"
#include "render/focused_dots/one_lane.h"

namespace gladstone::inline focused_dots {
MomentImages MomentImages::plan(double half_px, GaussianSpot<double> const& spot, double side, int terms) {
  constexpr std::size_t most_bytes = std::size_t{64} << 20;
  MomentImages images;
  images.lattice = MomentLattice::no_coarser(side);
  // The source's centre is up to half a pixel, plus `aside`, from the centre of the image; PSF footprints are centred
  // on whole pixels.
  images.half = static_cast<int>(std::ceil(half_px + 0.5 + MomentLattice::aside)) + spot.half_width();
  images.terms = terms;
  int const reach = 2 * spot.half_width() + 1;
  if (reach > most_lanes || !(half_px < 1000)) return {};
  images.stride = (images.width() * images.width() + lanes_for(reach) - reach + pad - 1) / pad * pad;
  return images.size() * sizeof(double) <= most_bytes ? images : MomentImages{};
}

std::vector<double> make_moment_images(MomentImages const& plan, CubatureView const& source, double half_px,
                                       GaussianSpot<double> const& spot) {
  std::vector<double> values(plan.size());
  parallel_for(static_cast<std::size_t>(plan.phases()), [&](std::size_t phase) {
    with_lanes(2 * spot.half_width() + 1, [&]<int lanes>() {
      double room[MomentImages::factors(lanes)];
      double* const first = values.data() + phase * plan.size() / static_cast<std::size_t>(plan.phases());
      add_to_images<lanes, DisplacementMoments::count>(OneLane{}, plan, source, half_px, spot, static_cast<int>(phase),
                                                       0, first, room, 1);
    });
  });
  return values;
}

}  // namespace gladstone::inline focused_dots
