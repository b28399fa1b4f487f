#pragma once

#include <cstddef>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "analysis/tracking/dot_location.h"
#include "render/base/image.h"

namespace gladstone::inline tracking {

/// Locates the dots of frames and stores the results of the last frames, so that a frame that belongs to several pairs
/// of a sequence is processed only once. Two frames are the same if all their grey levels are equal. Several threads
/// may use one object.
class LocatedFrames {
 public:
  using Located = std::shared_ptr<LocatedDots const>;

  /// @param most_frames  number of frames whose results are stored, at least one
  LocatedFrames(DotSettings const& settings, std::size_t most_frames)
      : settings_(settings), most_frames_(most_frames) {}

  /// Locates the dots of frames by locate_dots(). If another thread is already processing one of the frames, the call
  /// first processes the other frames and then waits for that thread.
  /// @param frames  frames to be processed; null: no frame
  /// @return one result per frame; null where there is no frame
  /// @throws Interrupted
  std::vector<Located> locate(std::span<Image<double> const* const> frames) const;

 private:
  struct Entry {
    Image<double> levels;
    std::promise<Located> promise;
    std::shared_future<Located> result{promise.get_future()};
  };

  /// Returns the stored entry of a frame, and true if the entry has just been added.
  std::pair<std::shared_ptr<Entry>, bool> find_or_add(Image<double> const& frame) const;
  void remove(std::shared_ptr<Entry> const& entry) const;

  DotSettings settings_;
  std::size_t most_frames_;
  mutable std::mutex mutex_;
  mutable std::list<std::shared_ptr<Entry>> entries_;  ///< stored frames, the most recently used one first
};

}  // namespace gladstone::inline tracking
