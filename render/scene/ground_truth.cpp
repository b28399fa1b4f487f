#include "render/scene/ground_truth.h"

namespace gladstone {

void GroundTruth::resize(std::size_t count) {
  position_m.resize(count);
  for (auto* column :
       {&reference_px, &displacement_px, &displacement_std_px, &flux, &eq9_px, &chief_px, &eq9_cone_px}) {
    column->resize(count);
  }
  rays.resize(count);
}

DisplacementField at_mid_position(GroundTruth const& truth, std::vector<Vec2d> const& displacement_px) {
  DisplacementField field;
  field.displacement_px = displacement_px;
  field.position_px.reserve(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    field.position_px.push_back(truth.reference_px[i] + 0.5 * truth.displacement_px[i]);
  }
  return field;
}

}  // namespace gladstone
