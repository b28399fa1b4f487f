#include "analysis/tracking/located_frames.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <utility>

namespace gladstone::inline tracking {
namespace {

/// Returns whether all levels of two images are equal, bit by bit, so that ignored pixels (NaN) are equal as well.
bool are_equal(Image<double> const& a, Image<double> const& b) {
  return a.columns() == b.columns() && a.rows() == b.rows() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

}  // namespace

std::vector<LocatedFrames::Located> LocatedFrames::locate(std::span<Image<double> const* const> frames) const {
  std::vector<std::shared_ptr<Entry>> entries(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!frames[i]) continue;
    auto [entry, added] = find_or_add(*frames[i]);
    entries[i] = entry;
    if (!added) continue;
    try {
      entry->promise.set_value(std::make_shared<LocatedDots const>(locate_dots(*frames[i], settings_)));
    } catch (...) {
      entry->promise.set_exception(std::current_exception());
      remove(entry);
      throw;
    }
  }
  std::vector<Located> located(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (entries[i]) located[i] = entries[i]->result.get();
  return located;
}

std::pair<std::shared_ptr<LocatedFrames::Entry>, bool> LocatedFrames::find_or_add(Image<double> const& frame) const {
  std::lock_guard const lock(mutex_);
  auto const known = std::find_if(entries_.begin(), entries_.end(),
                                  [&](std::shared_ptr<Entry> const& entry) { return are_equal(entry->levels, frame); });
  bool const added = known == entries_.end();
  if (added) {
    auto entry = std::make_shared<Entry>();
    entry->levels = frame;
    entries_.push_front(std::move(entry));
    if (entries_.size() > most_frames_) entries_.pop_back();
  } else {
    entries_.splice(entries_.begin(), entries_, known);
  }
  return {entries_.front(), added};
}

void LocatedFrames::remove(std::shared_ptr<Entry> const& entry) const {
  std::lock_guard const lock(mutex_);
  entries_.remove(entry);
}

}  // namespace gladstone::inline tracking
