#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <utility>

namespace gladstone::inline sweep {

/// Least-recently-used cache of values by a text key, with limits on the number of entries and on their size in bytes.
template <class Value>
class LruCache {
 public:
  explicit LruCache(std::size_t most) : most_(most) {}

  /// Returns the value and marks it as most recently used, or returns nullptr if it is not cached.
  Value* find(std::string const& key) {
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->key != key) continue;
      entries_.splice(entries_.begin(), entries_, entry);
      return &entries_.front().value;
    }
    return nullptr;
  }

  /// Adds a value of the given size; if the cache is full, the least recently used value is evicted.
  Value& keep(std::string const& key, Value value, std::size_t bytes = 0) {
    if (entries_.size() >= most_) drop_last();
    entries_.push_front({key, std::move(value), bytes});
    bytes_ += bytes;
    return entries_.front().value;
  }

  /// Evicts the least recently used values until `bytes` more fit into `most_bytes`, or the cache is empty.
  void make_room(std::size_t bytes, std::size_t most_bytes) {
    while (!entries_.empty() && bytes_ + bytes > most_bytes) drop_last();
  }

 private:
  struct Entry {
    std::string key;
    Value value;
    std::size_t bytes;
  };

  void drop_last() {
    bytes_ -= entries_.back().bytes;
    entries_.pop_back();
  }

  std::size_t most_, bytes_ = 0;
  std::list<Entry> entries_;  ///< most recently used first
};

}  // namespace gladstone::inline sweep
