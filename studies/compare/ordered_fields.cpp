#include "studies/compare/ordered_fields.h"

#include <utility>

namespace gladstone::inline compare {

bool OrderedFields::wait_for(std::size_t k) {
  std::unique_lock lock(mutex_);
  advanced_.wait(lock, [&] { return reason_ || k < next_ + window_; });
  return !reason_;
}

void OrderedFields::add(std::size_t k, DisplacementField field) {
  std::lock_guard const lock(mutex_);
  early_.emplace(k, std::move(field));
  for (auto first = early_.begin(); first != early_.end() && first->first == next_; first = early_.begin()) {
    receive_(next_++, std::move(first->second));
    early_.erase(first);
  }
  advanced_.notify_all();
}

void OrderedFields::stop(std::exception_ptr reason) {
  std::lock_guard const lock(mutex_);
  if (!reason_) reason_ = std::move(reason);
  advanced_.notify_all();
}

void OrderedFields::throw_if_stopped() const {
  if (reason_) std::rethrow_exception(reason_);
}

}  // namespace gladstone::inline compare
