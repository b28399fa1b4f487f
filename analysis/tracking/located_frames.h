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

namespace gladstone::tracking {

/// Locates the dots of frames, and remembers the last ones: a frame that belongs to several pairs of a sequence is
/// located once. Frames are equal if all their grey levels are. One object serves several threads.
class LocatedFrames {
 public:
  using Located = std::shared_ptr<LocatedDots const>;

  /// @param most_frames  number of frames that are remembered, at least one
  LocatedFrames(DotSettings const& settings, std::size_t most_frames)
      : settings_(settings), most_frames_(most_frames) {}

  /// Locates the dots of frames by locate_dots(). Those that another thread is locating are waited for after the
  /// others have been located.
  /// @param frames  null: no frame
  /// @return one result per frame; null without a frame
  /// @throws Interrupted
  std::vector<Located> locate(std::span<Image<double> const* const> frames) const;

 private:
  struct Entry {
    Image<double> levels;
    std::promise<Located> promise;
    std::shared_future<Located> result{promise.get_future()};
  };

  /// Returns the entry of a frame, and whether it is new.
  std::pair<std::shared_ptr<Entry>, bool> find_or_add(Image<double> const& frame) const;
  void remove(std::shared_ptr<Entry> const& entry) const;

  DotSettings settings_;
  std::size_t most_frames_;
  mutable std::mutex mutex_;
  mutable std::list<std::shared_ptr<Entry>> entries_;  ///< the last used one first
};

}  // namespace gladstone::tracking
