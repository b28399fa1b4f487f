#include <algorithm>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/frame_sized_image.h"

namespace gladstone {
namespace {

/// Computes the minimum or mean of images, pixel by pixel.
Image<double> background_of(std::vector<std::string> const& files, bool mean, Image<double> const& frame) {
  Image<double> background;
  for (std::string const& file : files) {
    Image<double> const picture = read_frame_sized_image(file, frame);
    if (background.empty()) {
      background = picture;
      continue;
    }
    for (std::size_t i = 0; i < picture.size(); ++i) {
      double& level = background.data()[i];
      level = mean ? level + picture.data()[i] : std::min(level, picture.data()[i]);
    }
  }
  if (mean)
    for (double& level : background) level /= static_cast<double>(files.size());
  return background;
}

void take_off(std::vector<std::string> const& files, bool mean, Image<double>& frame) {
  if (files.empty()) return;
  Image<double> const background = background_of(files, mean, frame);
  for (std::size_t i = 0; i < frame.size(); ++i) frame.data()[i] -= background.data()[i];
}

}  // namespace

FrameChange read_background(SetupTable& table, FramePreparation& preparation) {
  bool const mean = table.word("subtract", "minimum", {"minimum", "mean"}) == "mean";
  std::vector<SetupTable> frames = table.tables("frame");
  if (frames.empty())
    table.problem("frame",
                  "is missing (a background requires a sequence); give frame = [{ reference = \"a.tif\", flow = "
                  "\"b.tif\" }, ...]",
                  ProblemCode::missing_key);
  std::vector<std::string> reference, flow;
  for (SetupTable& pair : frames) {
    reference.push_back(pair.required_path("reference"));
    flow.push_back(pair.required_path("flow"));
  }
  for (auto const* files : {&reference, &flow})
    preparation.files.insert(preparation.files.end(), files->begin(), files->end());
  return [mean, reference, flow](PreparedFrames& prepared) {
    take_off(reference, mean, prepared.reference);
    take_off(flow, mean, prepared.flow);
  };
}

}  // namespace gladstone
