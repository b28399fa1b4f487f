#pragma once

#include <cstddef>
#include <string>

#include "render/base/progress.h"

namespace gladstone::inline cases {

/// Shows the progress over the pairs of a sequence and, meanwhile, disables that of the steps of each pair.
class PairProgress {
 public:
  PairProgress(std::string const& label, std::size_t total, bool shown)
      : shown_(shown), progress_(label, shown ? total : 0) {
    Progress::enable(false);
  }
  ~PairProgress() { Progress::enable(shown_); }
  PairProgress(PairProgress const&) = delete;
  PairProgress& operator=(PairProgress const&) = delete;
  void advance() { progress_.advance(); }

 private:
  bool shown_;
  Progress progress_;
  ProgressMonitor of_steps_;  ///< receives the progress of the steps, which is not shown
  ProgressMonitor::Scope scope_{of_steps_};
};

}  // namespace gladstone::inline cases
