#include "analysis/tracking/particle_tracks.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "analysis/tracking/nearest_points.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone::tracking {
namespace {

/// Possible continuation of a track.
struct Link {
  bool starting;      ///< whether the track has a single place so far
  double cost;        ///< distance between prediction and particle [px]
  std::size_t track;  ///< index among the open tracks
  std::size_t particle;

  auto key() const { return std::tuple(starting, cost, track, particle); }
};

/// State of the tracking between two frames.
class FourFrameStep {
 public:
  FourFrameStep(std::span<std::vector<Vec2d> const> frames, std::size_t frame, TrackSettings const& settings)
      : frames_(frames), frame_(frame), next_(frames[frame + 1]) {
    if (frame + 2 < frames.size()) after_.emplace(frames[frame + 2]);
    search_ = settings.search_radius_px > 0 ? settings.search_radius_px : 0.5 * next_.spacing();
    start_ = settings.start_radius_px > 0 ? settings.start_radius_px : search_;
  }

  /// Returns the possible continuations of a track.
  std::vector<Link> links(Track const& track, std::size_t index, DisplacementPrediction const& predict) const {
    bool const starting = track.length() == 1;
    Vec2d const here = place(track, 0);
    Vec2d const step = starting ? (predict ? predict(here) : Vec2d{}) : here - place(track, 1);
    std::vector<Link> found;
    if (!is_finite(here) || !is_finite(step)) return found;
    double const radius = starting ? start_ : search_;
    for (std::size_t const k : next_.within(here + step, radius)) {
      Vec2d const there = frames_[frame_ + 1][k];
      double cost = length(there - here - step);
      if (after_) {
        Vec2d const extended = starting ? 2.0 * there - here : 3.0 * (there - here) + place(track, 1);
        // Without a particle in the frame after the next, the distance decides among equally bad candidates.
        double const distance = after_->distance(extended, search_);
        cost = std::isfinite(distance) ? distance : search_ + cost;
      }
      found.push_back({starting, cost, index, k});
    }
    return found;
  }

 private:
  /// Place of a track `back` frames before the present one.
  Vec2d place(Track const& track, std::size_t back) const {
    return frames_[frame_ - back][track.particles[track.length() - 1 - back]];
  }

  std::span<std::vector<Vec2d> const> frames_;
  std::size_t frame_;
  NearestPoints next_;
  std::optional<NearestPoints> after_;  // the frame after the next one, if there is one
  double search_ = 0, start_ = 0;
};

}  // namespace

std::vector<Track> track_particles(std::span<std::vector<Vec2d> const> frames, DisplacementPrediction const& predict,
                                   TrackSettings const& settings) {
  std::vector<Track> open, done;
  auto const start = [&](std::size_t frame, std::vector<char> const& taken) {
    for (std::size_t k = 0; k < frames[frame].size(); ++k)
      if (!taken[k] && is_finite(frames[frame][k])) open.push_back({frame, {k}});
  };
  if (frames.empty()) return done;
  start(0, std::vector<char>(frames[0].size()));
  for (std::size_t frame = 0; frame + 1 < frames.size(); ++frame) {
    FourFrameStep const step(frames, frame, settings);
    std::vector<std::vector<Link>> of_track(open.size());
    parallel_chunks(open.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) of_track[i] = step.links(open[i], i, predict);
    });
    std::vector<Link> links;
    for (std::vector<Link> const& own : of_track) links.insert(links.end(), own.begin(), own.end());
    std::sort(links.begin(), links.end(), [](Link const& a, Link const& b) { return a.key() < b.key(); });
    std::vector<char> taken(frames[frame + 1].size()), continued(open.size());
    for (Link const& link : links) {
      if (continued[link.track] || taken[link.particle]) continue;
      continued[link.track] = taken[link.particle] = 1;
      open[link.track].particles.push_back(link.particle);
    }
    std::vector<Track> going;
    for (std::size_t i = 0; i < open.size(); ++i) (continued[i] ? going : done).push_back(std::move(open[i]));
    open = std::move(going);
    start(frame + 1, taken);
  }
  done.insert(done.end(), open.begin(), open.end());
  std::erase_if(done, [&](Track const& track) { return track.length() < settings.shortest_track; });
  std::sort(done.begin(), done.end(), [](Track const& a, Track const& b) {
    return std::tuple(a.first_frame, a.particles.front()) < std::tuple(b.first_frame, b.particles.front());
  });
  return done;
}

DisplacementField track_vectors(std::span<Track const> tracks, std::span<std::vector<Vec2d> const> frames,
                                std::span<std::vector<Vec2d> const> sigmas, std::size_t frame) {
  GLADSTONE_EXPECTS(frame + 1 < frames.size() && (sigmas.empty() || sigmas.size() == frames.size()));
  DisplacementField field;
  for (Track const& track : tracks) {
    if (track.first_frame > frame || track.first_frame + track.length() < frame + 2) continue;
    std::size_t const i = track.particles[frame - track.first_frame],
                      k = track.particles[frame - track.first_frame + 1];
    Vec2d const a = frames[frame][i], b = frames[frame + 1][k];
    field.position_px.push_back(0.5 * (a + b));
    field.displacement_px.push_back(b - a);
    field.status.push_back(VectorStatus::valid);
    field.reason.push_back(VectorReason::measured);
    if (sigmas.empty()) continue;
    Vec2d const s = sigmas[frame][i], t = sigmas[frame + 1][k];
    field.sigma_px.push_back({std::hypot(s.x, t.x), std::hypot(s.y, t.y)});
  }
  return field;
}

}  // namespace gladstone::tracking
