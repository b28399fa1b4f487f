#pragma once

#include <memory>
#include <mutex>
#include <semaphore>
#include <utility>
#include <vector>

#include "cuda/device/device_array.h"

namespace gladstone::cuda::inline device {

/// Page-locked buffers for several threads that copy data for one device: while it works on the data of one thread,
/// others fill their buffers. Their number is limited, since page-locked memory is not available to other programs.
class StagingPool {
 public:
  static constexpr int most_buffers = 4;

  /// RAII guard: a buffer of the pool. The pool must outlive it.
  class Buffer {
   public:
    Buffer(StagingPool& pool, std::unique_ptr<PinnedBuffer> buffer) : pool_(&pool), buffer_(std::move(buffer)) {}
    Buffer(Buffer&& other) noexcept = default;
    Buffer& operator=(Buffer&&) = delete;
    ~Buffer() {
      if (buffer_) pool_->release(std::move(buffer_));
    }
    PinnedBuffer* operator->() const { return buffer_.get(); }

   private:
    StagingPool* pool_;
    std::unique_ptr<PinnedBuffer> buffer_;
  };

  /// Returns an idle buffer; waits for one while all are in use.
  Buffer acquire() {
    available_.acquire();
    std::lock_guard const lock(mutex_);
    std::unique_ptr<PinnedBuffer> buffer = std::move(idle_.back());
    idle_.pop_back();
    return {*this, std::move(buffer)};
  }

  StagingPool() {
    for (int k = 0; k < most_buffers; ++k) idle_.push_back(std::make_unique<PinnedBuffer>());
  }
  StagingPool(StagingPool const&) = delete;
  StagingPool& operator=(StagingPool const&) = delete;

 private:
  void release(std::unique_ptr<PinnedBuffer> buffer) {
    {
      std::lock_guard const lock(mutex_);
      idle_.push_back(std::move(buffer));  // does not throw, since the capacity suffices
    }
    available_.release();
  }

  std::counting_semaphore<most_buffers> available_{most_buffers};
  std::mutex mutex_;
  std::vector<std::unique_ptr<PinnedBuffer>> idle_;  ///< idle buffers, the most recently used one last
};

}  // namespace gladstone::cuda::inline device
