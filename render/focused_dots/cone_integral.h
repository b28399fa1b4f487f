#pragma once

#include "render/focused_dots/dot_model.h"

/// Ray tracing of a dot and the integral over its light cone, by a group of lanes: OneLane on the CPU, a block of
/// threads on a GPU.
namespace gladstone::inline focused_dots {

/// Results of a dot after its rays are traced and its light cone is integrated.
struct DotCone {
  DotKind kind = DotKind::left;
  Vec2d centre{}, aim{};
  double light = 0;  ///< light in the reference image [fully lit px]
  TableCheck check;
  CheckErrors errors{};
  Vec2d origin{};     ///< mean displacement, to which the cone's displacements are relative [px]
  Extent extent;      ///< range of displacements relative to `origin`
  MomentField field;  ///< moments as a function of the position on the dot; only for DotKind::narrow
};

/// Results of a dot that a renderer stores.
struct DotFound {
  DotTruth truth;
  int rays = 0;       ///< number of rays traced
  bool left = false;  ///< true for a fallback dot, to be rendered by another renderer
};

/// Aims at a dot, traces an adaptive number of rays and compares them with the deflection table.
/// @param lanes  group with storage for sums: check(ray) is this lane's sum for a ray, of_scramblings() returns the
/// sums of all lanes for each scrambling, count(frame, status) counts a ray; each lane traces `abreast` rays together
/// @param dot  receives the results, except its light
/// @param found  receives ray counts and the origin of the truth
/// @return the aim
template <class Lanes, class Medium>
GLADSTONE_HD DotAim check_dot(Lanes& lanes, DotModel const& model, Medium const& medium, Vec2d centre, DotCone& dot,
                              DotFound& found) {
  constexpr int abreast = Lanes::abreast;
  DotAim const aim = aim_dot(model, centre);
  DotKind kind = aim.kind;
  TableCheck all;
  CheckErrors errors{};
  int passing[frame_count] = {}, traced = 0;
  lanes.clear();
  for (int enough = model.fewest_rays; kind == DotKind::narrow;
       enough = 2 * enough < model.most_rays ? 2 * enough : model.most_rays) {
    bool lost = false;
    for (int first = traced + abreast * lanes.lane(); first < enough; first += abreast * lanes.size()) {
      lanes.poll();  // check for an interruption, since a ray may have a million steps
      Vec2d from[abreast], pupil[abreast];
      Deflection ray[abreast];
      for (int i = 0; i < abreast; ++i) {
        DotRay const sent =
            DotRay::choose(model.choice, model.shape, centre, first + i < enough ? first + i : enough - 1);
        from[i] = centre + model.offset(sent.place);
        pupil[i] = aim.pupil + model.stop_radius * sent.at;
      }
      deflect(model.bench, medium, from, pupil, ray);
      for (int i = 0; i < abreast && first + i < enough; ++i) {
        Vec2d const crossing = model.table.crossing(from[i], pupil[i]);
        lanes.check(first + i).add(
            pupil[i] - aim.pupil, ray[i],
            {model.table.displacement(crossing, pupil[i]), model.table.shift(crossing, pupil[i])});
        lost = lost || ray[i].status != RayStatus::alive;
        Vec2d pixel = model.to_pixel(from[i]), arrival = pupil[i];
        for (int frame = 0; frame < frame_count; ++frame) {
          RayStatus const status = frame == 1 && ray[i].status != RayStatus::alive ? ray[i].status
                                   : length(arrival) > model.stop_radius           ? RayStatus::vignetted
                                   : model.sees(pixel)                             ? RayStatus::alive
                                                                                   : RayStatus::missed_sensor;
          passing[frame] += reaches_sensor_plane(status) ? 1 : 0;
          lanes.count(frame, status);
          pixel += ray[i].displacement;
          arrival += ray[i].shift;
        }
      }
    }
    traced = enough;
    TableCheck const* const of_scramblings = lanes.of_scramblings();
    all = {};
    for (int i = 0; i < model.scramblings(); ++i) all += of_scramblings[i];
    errors = check_errors(of_scramblings, model.scramblings(), all);
    lanes.sync();
    if (lanes.any(lost)) kind = DotKind::left;
    if (model.enough(errors, traced)) break;
  }
  for (int& count : passing) count = lanes.sum(count);
  if (lanes.lane() != 0) return aim;
  dot.kind = kind;
  dot.centre = centre;
  dot.aim = aim.pupil;
  dot.check = all;
  dot.errors = errors;
  found = {{}, traced, kind == DotKind::left};
  found.truth.origin = model.to_pixel(centre);
  for (int frame = 0; frame < frame_count; ++frame) found.truth.hits[frame].count = passing[frame];
  return aim;
}

GLADSTONE_HD inline CorrectedCone make_corrected_cone(DotModel const& model, DotCone const& dot) {
  DeflectionTable const nothing;
  return {dot.kind == DotKind::still ? nothing : model.table,
          model.stop_radius,
          model.distance(),
          dot.centre,
          dot.aim,
          dot.check};
}

/// Integrals over a dot's light cone, shared by the lanes of a group.
struct ConeIntegral {
  DisplacementMoments
      moments[PlaceRule::max_positions];            ///< moments of the whole cone at each point of the source rule
  double without_medium[PlaceRule::max_positions];  ///< sum of weights in the reference image
  double* rims = nullptr;                    ///< [point of the source][direction] distance from the cone's centre to
                                             ///< the ray at the edge of the stop [m]; memory of the caller
  Extent extents[PlaceRule::max_positions];  ///< range of displacements
  bool simple, sound, narrow;  ///< simple: the edge of the stop is single-valued; sound: the moments are finite;
                               ///< narrow: the spread is narrow
};

/// Computes the moments of the whole cone at every point of the source rule, one team per point, and determines from
/// the moments how the light of the dot is rendered.
/// @param points  [place][point] receives the nodes of the rule, unless null
template <class Group>
GLADSTONE_HD void integrate_cone(Group const& group, DotModel const& model, CorrectedCone const& cone,
                                 ConeIntegral& whole, ConeLight* points) {
  auto const team = group.team();
  if (group.lane() == 0) whole.simple = whole.sound = whole.narrow = true;
  group.sync();
  for (int place = team.index(); place < model.places.count; place += team.count()) {
    Vec2d const offset = model.offset(model.places.places[place]);
    bool simple = true;
    for (int k = team.lane(); k < model.cone.direction_count; k += team.size()) {
      double const rim = cone.rim(offset, model.cone.directions[k]);
      whole.rims[place * model.cone.direction_count + k] = rim;
      simple = simple && rim == rim;
    }
    if (!team.all(simple)) whole.simple = false;
  }
  group.sync();
  int const count = model.cone.points_of(whole.simple);
  for (int place = team.index(); place < model.places.count; place += team.count()) {
    Vec2d const offset = model.offset(model.places.places[place]);
    double const* const rims = whole.simple ? whole.rims + place * model.cone.direction_count : nullptr;
    DisplacementMoments moments;
    double without_medium = 0;
    Extent extent;
    for (int k = team.lane(); k < count; k += team.size()) {
      ConeLight const light = cone_light(cone, model.cone, k, offset, rims);
      if (points) points[place * count + k] = light;
      moments.add(light.weight, light.displacement);
      if (light.weight != 0) extent.include(light.displacement);
      without_medium += light.without_medium;
    }
    without_medium = team.sum(without_medium);
    for (double& moment : moments.of) moment = team.sum(moment);
    extent = team.spanned(extent);
    if (team.lane() != 0) continue;
    cone.finish(moments, without_medium);
    whole.moments[place] = moments;
    whole.without_medium[place] = without_medium;
    whole.extents[place] = extent;
    double const square = moments.square();
    if (!(square - square == 0)) whole.sound = false;
    if (!model.narrow(moments)) whole.narrow = false;
  }
  group.sync();
}

/// Computes the truth of a dot from the integrals over its cone and determines how its light is rendered.
template <class Group>
GLADSTONE_HD void conclude(Group const& group, DotModel const& model, Vec2d origin, ConeIntegral const& whole,
                           DotCone& dot, DotFound& found) {
  using std::sqrt;
  using M = DisplacementMoments;
  constexpr int terms = PlaceRule::terms;
  for (int k = group.lane(); whole.narrow && k < M::count * terms; k += group.size()) {
    dot.field.coefficient[k / terms][k % terms] =
        MomentField::fitted(model.places, whole.moments, k / terms, k % terms);
  }
  if (group.lane() != 0) return;
  if (!whole.sound) dot.kind = DotKind::left;
  DotTruth& truth = found.truth;
  dot.origin = origin;
  dot.extent = {};
  for (int place = 0; place < model.places.count; ++place) dot.extent.include(whole.extents[place]);
  MomentImages const& images = model.moment_images;
  if (dot.kind == DotKind::narrow && !whole.narrow) {
    bool const few = images.exist() && SpannedSquares(images.lattice, truth.origin + origin, dot.extent).few;
    dot.kind = few ? DotKind::wide : DotKind::left;
  }
  PlaceRule const& rule = model.places;
  double all = 0;
  for (int i = 0; i < rule.count; ++i) all += rule.weights[i] * whole.without_medium[i];
  for (int i = 0; i < rule.count; ++i) {
    double const weight = dot.light * (rule.weights[i] * whole.without_medium[i] / all);
    double const(&of)[M::count] = whole.moments[i].of;
    Vec2d const at = model.half_size_px() * rule.places[i], moved = at + origin, mean{of[M::at(1, 0)], of[M::at(0, 1)]};
    truth.hits[0].add(at, weight, false);
    truth.hits[1].weight += weight * of[0];
    truth.hits[1].first += weight * (of[0] * moved + mean);
    truth.hits[1].second += weight * Vec2d{of[0] * moved.x * moved.x + 2 * moved.x * mean.x + of[M::at(2, 0)],
                                           of[0] * moved.y * moved.y + 2 * moved.y * mean.y + of[M::at(0, 2)]};
  }
  if (dot.kind == DotKind::still) {
    truth.hits[1] = truth.hits[0];
  } else {
    Vec2d const square = model.error2(dot.errors, whole.simple);
    truth.error = {sqrt(square.x), sqrt(square.y)};
  }
  truth.path = TruthPath::table;
  found.left = dot.kind == DotKind::left;
}

}  // namespace gladstone::inline focused_dots
