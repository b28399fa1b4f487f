#include "studies/design/bounds.h"

namespace gladstone {

BoundKey bound_key(Bound bound) {
  using unit::mm;
  switch (bound) {
    case Bound::gradient_min:
      return {"requirements.gradient_min_kg_m4", 1};
    case Bound::resolution:
      return {"requirements.resolution_mm", mm};
    case Bound::displacement_max:
      return {"requirements.displacement_max_px", 1};
    case Bound::uncertainty_max:
      return {"requirements.uncertainty_max_px", 1};
    case Bound::view_width:
      return {"requirements.field_of_view_mm[0]", mm};
    case Bound::view_height:
      return {"requirements.field_of_view_mm[1]", mm};
    case Bound::z_total:
      return {"limits.z_total_max_mm", mm};
    default:
      return {"", 1};
  }
}

std::string bound_name(Bound bound) {
  switch (bound) {
    case Bound::focus:
      return "focus on the dots";
    case Bound::dots_clear:
      return "dots outside the medium";
    case Bound::lens_clear:
      return "lens outside the medium";
    case Bound::dot_least:
      return "smallest dot images for which the random error is known";
    case Bound::dot_most:
      return "largest dot images for which the random error is known";
    case Bound::coverage:
      return "space between the dots";
    case Bound::noise_most:
      return "largest image noise for which the random error is known";
    case Bound::full_well:
      return "peaks below the full well";
    default:
      return bound_key(bound).path;
  }
}

std::vector<Limit> required_limits(Requirements const& r) {
  std::vector<Limit> limits;
  auto const add = [&limits](Bound bound, std::optional<double> value) {
    if (value) limits.push_back({bound, *value});
  };
  add(Bound::gradient_min, r.gradient_min);
  add(Bound::resolution, r.resolution);
  add(Bound::displacement_max, r.displacement_max);
  add(Bound::uncertainty_max, r.uncertainty_max);
  if (r.field_of_view) {
    add(Bound::view_width, r.field_of_view->x);
    add(Bound::view_height, r.field_of_view->y);
  }
  add(Bound::z_total, r.z_total_max);
  return limits;
}

std::vector<Limit> feasibility_limits(FixedDesignParameters const& given) {
  constexpr double clearance = 1.02;  // distance from the mid-plane, in half thicknesses
  std::vector<Limit> limits{{Bound::focus, 0},
                            {Bound::dots_clear, clearance * given.thickness / 2},
                            {Bound::lens_clear, clearance * given.thickness / 2},
                            {Bound::dot_least, random_error_range.least_dot},
                            {Bound::dot_most, random_error_range.most_image},
                            {Bound::coverage, most_coverage},
                            {Bound::noise_most, random_error_range.most_noise}};
  if (given.light || given.camera.exposure_e) limits.push_back({Bound::full_well, given.camera.noise.full_well_e});
  return limits;
}

}  // namespace gladstone
