#pragma once

#include "render/focused_dots/trace_pair.h"

namespace gladstone {

/// How points of the target and rays show on the sensor of a scene whose lens is ideal; the same for all dots.
struct TargetImage {
  Vec2d axis_px{};            ///< where the optical axis meets the sensor [px]
  double px_per_metre = 0;    ///< of the target: magnification over pixel pitch [px/m]
  double source_half = 0;     ///< radius of a dot, half the side of a picture's pixel [m]
  double stop_radius = 1;     ///< [m]; 1 where there is no stop
  bool has_stop = false;      ///< false: chief rays only
  ApertureStop<double> stop;  ///< meaningless without one

  /// Where the chief ray of a point of the target ends without medium [px].
  GLADSTONE_HD Vec2d to_pixel(Vec2d on_target) const {
    return {axis_px.x + px_per_metre * on_target.x, axis_px.y - px_per_metre * on_target.y};
  }
  GLADSTONE_HD double half_size_px() const { return source_half * px_per_metre; }
};

/// What one ray tells of its dot's light in both frames. Aligned so that a device writes and reads it in pairs of
/// numbers.
template <class T>
struct alignas(2 * sizeof(T)) RayRecord {
  Vec2<T> place;      ///< on the source, in units of its half size, as the picture shows it (y downwards)
  Vec2<T> pupil;      ///< where it meets the lens plane in the reference frame [m]
  Vec2<T> arrival;    ///< the same in the flow frame [m]
  Vec2<T> reference;  ///< hits, from the image of the dot's centre [px]
  Vec2<T> flow;
  T weight{};            ///< radiance cos^4 as emitted
  T reference_weight{};  ///< what of it passes the stop in either frame
  T flow_weight{};
  bool reference_counts = false;  ///< past the stop and on the sensor's plane
  bool flow_counts = false;
  bool leaves_medium = false;  ///< in the flow, to reach the lens plane
  bool moved = false;          ///< whether the flow did anything to it

  GLADSTONE_HD Vec2<T> bend() const { return arrival - pupil; }
};

/// @param origin image of the dot's centre [px]
template <class T>
GLADSTONE_HD RayRecord<T> make_record(TargetImage const& image, Vec2<T> centre, Vec2<T> origin,
                                      EmittedRay<T> const& emitted, RayHit<T> const& reference, RayHit<T> const& flow) {
  RayRecord<T> record;
  if (image.source_half > 0) {
    T const unit = T(1) / T(image.source_half);
    record.place = {(emitted.ray.position.x - centre.x) * unit, (centre.y - emitted.ray.position.y) * unit};
  }
  record.pupil = reference.at_lens;
  record.arrival = flow.at_lens;
  record.reference = reference.weight != T(0) ? reference.pixel - origin : Vec2<T>{};
  record.flow = flow.weight != T(0) ? flow.pixel - origin : Vec2<T>{};
  record.weight = emitted.weight;
  record.reference_weight = reference.weight;
  record.flow_weight = flow.weight;
  record.reference_counts = reaches_sensor_plane(reference.status);
  record.flow_counts = reaches_sensor_plane(flow.status);
  record.leaves_medium = flow.status <= RayStatus::vignetted;
  record.moved = !(record.flow == record.reference && record.arrival == record.pupil &&
                   record.flow_weight == record.reference_weight);
  return record;
}

}  // namespace gladstone
