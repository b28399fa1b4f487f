#include <fmt/format.h>

#include <memory>
#include <mutex>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/frame_sized_image.h"
#include "analysis/preparation/sequence_background.h"
#include "render/base/error.h"

namespace gladstone::inline preparation {
namespace {

void subtract_background(Image<double> const& background, Image<double>& frame) {
  if (background.columns() != frame.columns() || background.rows() != frame.rows())
    throw DataError(ErrorCode::wrong_shape, KeyPath{"correlate.preprocess"},
                    fmt::format("the background is {} x {} px, but the frames are {} x {} px (the background is "
                                "subtracted pixel by pixel); correlate frames of one size",
                                background.columns(), background.rows(), frame.columns(), frame.rows()));
  for (std::size_t i = 0; i < frame.size(); ++i) frame.data()[i] -= background.data()[i];
}

/// Backgrounds computed from the files listed in the setup, when the first pair of frames is prepared; later pairs
/// reuse them.
class ListedBackground {
 public:
  ListedBackground(std::string statistic, std::vector<std::string> reference, std::vector<std::string> flow)
      : statistic_(std::move(statistic)), reference_files_(std::move(reference)), flow_files_(std::move(flow)) {}

  void subtract_from(PreparedFrames& frames) {
    {
      std::lock_guard const lock(mutex_);
      if (reference_.empty()) {
        flow_ = compute(flow_files_, frames.flow);
        reference_ = compute(reference_files_, frames.reference);
      }
    }
    subtract_background(reference_, frames.reference);
    subtract_background(flow_, frames.flow);
  }

 private:
  Image<double> compute(std::vector<std::string> const& files, Image<double> const& frame) const {
    return compute_background(statistic_, files.size(),
                              [&](std::size_t k) { return std::optional(read_frame_sized_image(files[k], frame)); });
  }

  std::string statistic_;
  std::vector<std::string> reference_files_, flow_files_;
  std::mutex mutex_;
  Image<double> reference_, flow_;
};

}  // namespace

FrameChange make_background_subtraction(std::shared_ptr<SequenceBackground const> const& background) {
  return [background](PreparedFrames& prepared) {
    subtract_background(background->reference, prepared.reference);
    subtract_background(background->flow, prepared.flow);
  };
}

FrameChange make_background_subtraction(std::string const& statistic, std::vector<std::string> const& reference,
                                        std::vector<std::string> const& flow) {
  auto const listed = std::make_shared<ListedBackground>(statistic, reference, flow);
  return [listed](PreparedFrames& prepared) { listed->subtract_from(prepared); };
}

}  // namespace gladstone::inline preparation
