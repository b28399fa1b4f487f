#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <utility>

namespace gladstone {

/// The last few values by the text that they depend on, and no more than so many bytes of them.
template <class Value>
class Recent {
 public:
  explicit Recent(std::size_t most) : most_(most) {}

  /// Nothing where it is not kept. What is found counts as used last.
  Value* find(std::string const& key) {
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->key != key) continue;
      entries_.splice(entries_.begin(), entries_, entry);
      return &entries_.front().value;
    }
    return nullptr;
  }

  /// Keeps a value that takes so many bytes, instead of the one used longest ago where there are too many.
  Value& keep(std::string const& key, Value value, std::size_t bytes = 0) {
    if (entries_.size() >= most_) drop_last();
    entries_.push_front({key, std::move(value), bytes});
    bytes_ += bytes;
    return entries_.front().value;
  }

  /// Drops those used longest ago until so many bytes more make no more than most_bytes, or none is left.
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
  std::list<Entry> entries_;  ///< the one used last comes first
};

}  // namespace gladstone
