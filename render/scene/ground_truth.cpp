#include "render/scene/ground_truth.h"

#include <limits>

namespace gladstone {

void GroundTruth::resize(std::size_t count) {
  position_m.resize(count);
  for (auto* column :
       {&reference_px, &displacement_px, &displacement_std_px, &flux, &eq9_px, &chief_px, &eq9_cone_px}) {
    column->resize(count);
  }
  rays.resize(count);
}

void GroundTruth::set_hits(std::size_t dot, Vec2d origin, CentroidSum<double> const& reference,
                           CentroidSum<double> const& flow, double light_per_weight) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Vec2d const none{nan, nan};
  bool const seen[2] = {reference.weight > 0, flow.weight > 0};
  reference_px[dot] = seen[0] ? origin + reference.mean() : none;
  displacement_px[dot] = seen[0] && seen[1] ? flow.mean() - reference.mean() : none;
  displacement_std_px[dot] = seen[1] ? flow.deviation() : none;
  flux[dot] = {reference.weight * light_per_weight, flow.weight * light_per_weight};
  rays[dot] = {reference.count, flow.count};
}

void GroundTruth::set_theory(std::size_t dot, TheoryModel const& model, GradientIntegral<double> const& chief,
                             ConeSum const& cone) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  eq9_px[dot] = model.displacement(chief.plain, model.lever);
  chief_px[dot] = model.displacement(chief.levered, 1.0);
  eq9_cone_px[dot] = cone.weight > 0 ? model.displacement(cone.levered / cone.weight, 1.0) : Vec2d{nan, nan};
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
