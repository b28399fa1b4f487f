#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <mutex>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline compare {

/// Receives fields that several threads compute in any order, and passes them on in ascending order. The number of
/// fields that wait for an earlier one is limited, so that the memory is bounded.
class OrderedFields {
 public:
  /// @param window   a field is computed once fewer than `window` fields before it are missing
  /// @param receive  called for field 0, 1, 2, ..., by one thread at a time
  OrderedFields(std::size_t window, std::function<void(std::size_t k, DisplacementField field)> receive)
      : window_(window), receive_(std::move(receive)) {}

  /// Waits until field k may be computed. @return false if the computation was stopped
  bool wait_for(std::size_t k);
  /// Adds field k. @throws the exceptions of `receive`
  void add(std::size_t k, DisplacementField field);
  /// Stops the computation for the reason of an exception; only the first one is retained.
  void stop(std::exception_ptr reason);
  /// Throws the exception that stopped the computation, if there is one.
  void throw_if_stopped() const;

 private:
  std::size_t window_;
  std::function<void(std::size_t k, DisplacementField field)> receive_;
  std::mutex mutex_;
  std::condition_variable advanced_;
  std::size_t next_ = 0;                            ///< field that is passed on next
  std::map<std::size_t, DisplacementField> early_;  ///< fields that wait for an earlier one
  std::exception_ptr reason_;
};

}  // namespace gladstone::inline compare
