#include "studies/compare/sequence_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <optional>
#include <set>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/source_files.h"
#include "studies/case/pair_progress.h"

namespace gladstone::inline compare {
namespace {

Image<double> compute_background_image(std::string const& statistic, std::vector<SequenceFrame> const& frames,
                                       SequenceSize const& size, bool show_progress) {
  PairProgress progress("background", frames.size(), show_progress);
  return compute_background(statistic, frames.size(), [&](std::size_t k) -> std::optional<Image<double>> {
    throw_if_interrupted();
    progress.advance();
    try {
      SequenceImage image = read_sequence_image(frames[k]);
      size.require(image.levels, frames[k].name());
      if (count_not_finite(image.levels) > 0) return std::nullopt;
      return std::move(image.levels);
    } catch (DataError const&) {  // the problem is reported when the pair is correlated
      return std::nullopt;
    }
  });
}

}  // namespace

SequenceImage read_sequence_image(SequenceFrame const& frame) {
  ImageMetadata metadata;
  SequenceImage image;
  image.levels = frame.pages > 1 ? frame.located->read(frame.page, &metadata) : read_image(frame.path, &metadata);
  image.sha256 = pixel_sha256(image.levels, metadata.sample_bits);
  if (metadata.channels >= 3)
    image.warnings.push_back(
        {WarningCode::assumed, frame.name(), "is a colour image: its luminance (Rec. 709) is correlated"});
  if (metadata.orientation != 1)
    image.warnings.push_back(
        {WarningCode::assumed, frame.name(),
         fmt::format("is stored rotated or mirrored (Orientation {}), and was rotated upright", metadata.orientation)});
  if (std::size_t const bad = count_not_finite(image.levels); bad == image.levels.size()) {
    throw DataError(ErrorCode::invalid_value, frame.name(), "all of its pixels are nan or infinite; export it again");
  } else if (bad > 0) {
    image.warnings.push_back({WarningCode::excluded, frame.name(),
                              fmt::format("{} pixels are nan or infinite, and are excluded from their windows", bad)});
  }
  return image;
}

void SequenceSize::require(Image<double> const& levels, std::string const& name) const {
  if (levels.columns() == columns && levels.rows() == rows) return;
  throw DataError(ErrorCode::wrong_shape, name,
                  fmt::format("is {} x {} px but {} is {} x {} px (all frames must have one size)", levels.columns(),
                              levels.rows(), frame, columns, rows));
}

SequenceSize find_commonest_size(std::vector<SequencePair> const& pairs) {
  struct Candidate {
    SequenceSize size;
    std::size_t frames = 0;
  };
  std::vector<Candidate> candidates;
  std::exception_ptr first_error;
  std::set<std::string> counted;  // a frame may be part of several pairs
  for (SequencePair const& pair : pairs) {
    for (SequenceFrame const* frame : {&pair.reference, &pair.flow}) {
      throw_if_interrupted();
      if (!counted.insert(frame->name()).second) continue;
      try {
        std::array<int, 2> const size =
            frame->located ? frame->located->size(frame->page) : ImagePages(frame->path).size(frame->page);
        auto const known = std::find_if(candidates.begin(), candidates.end(), [&](Candidate const& candidate) {
          return candidate.size.columns == size[0] && candidate.size.rows == size[1];
        });
        if (known == candidates.end())
          candidates.push_back({{size[0], size[1], frame->name()}, 1});
        else
          ++known->frames;
      } catch (DataError const&) {  // the problem is reported when the pair is correlated
        if (!first_error) first_error = std::current_exception();
      }
    }
  }
  if (candidates.empty()) std::rethrow_exception(first_error);
  return std::max_element(candidates.begin(), candidates.end(),
                          [](Candidate const& a, Candidate const& b) { return a.frames < b.frames; })
      ->size;
}

void compute_background_images(SequenceBackground& background, std::vector<SequencePair> const& pairs, Pairing pairing,
                               SequenceSize const& size, bool show_progress) {
  std::vector<SequenceFrame> first, second;
  for (SequencePair const& pair : pairs) {
    first.push_back(pair.reference);
    second.push_back(pair.flow);
  }
  bool const separate = pairing == Pairing::pairs;
  if (pairing == Pairing::reference) first = {first.front()};
  if (pairing == Pairing::consecutive) second = {second.back()};
  if (!separate) first.insert(first.end(), second.begin(), second.end());
  auto const compute = [&](std::vector<SequenceFrame> const& frames) {
    return compute_background_image(background.statistic, frames, size, show_progress);
  };
  background.reference = compute(first);
  background.flow = separate ? compute(second) : background.reference;
  if (background.reference.empty() || background.flow.empty())
    throw DataError(ErrorCode::undetermined, KeyPath{"correlate.preprocess"},
                    "no frame is suitable for the background; check that they are readable");
}

}  // namespace gladstone::inline compare
