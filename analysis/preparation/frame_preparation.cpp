#include "analysis/preparation/frame_preparation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "analysis/preparation/frame_changes.h"
#include "render/base/contracts.h"

namespace gladstone {
namespace {

struct NamedChange {
  char const* name;
  FrameChange (*read)(SetupTable& table, FramePreparation& preparation);
};

/// All masks.
constexpr std::array masks{
    NamedChange{"polygon", read_polygon_mask},
    NamedChange{"image", read_image_mask},
    NamedChange{"intensity", read_intensity_mask},
};

/// All preprocessing steps.
constexpr std::array steps{
    NamedChange{"background", read_background}, NamedChange{"high_pass", read_high_pass},
    NamedChange{"clahe", read_clahe},           NamedChange{"intensity_cap", read_intensity_cap},
    NamedChange{"min_max", read_min_max},
};

template <class Rows>
std::vector<std::string> names_of(Rows const& rows) {
  std::vector<std::string> names;
  for (NamedChange const& row : rows) names.emplace_back(row.name);
  return names;
}

std::string quoted(std::vector<std::string> const& names) {
  std::string text;
  for (std::string const& name : names) text += (text.empty() ? "\"" : ", \"") + name + '"';
  return text;
}

template <class Rows>
void read_changes(SetupTable& correlate, std::string const& key, Rows const& rows, std::vector<FrameChange>& changes,
                  FramePreparation& preparation) {
  for (SetupTable& table : correlate.tables(key)) {
    std::string const kind = table.kind_word("kind", "", names_of(rows));  // "" if the value was rejected
    if (!table.has("kind")) {
      table.problem("kind", "is missing; give " + quoted(names_of(rows)), ErrorCode::missing_key);
      table.suppress_unread_keys();
    }
    for (NamedChange const& row : rows)
      if (kind == row.name) changes.push_back(row.read(table, preparation));
  }
}

/// Replaces invalid pixels by the mean grey level of the valid ones.
void fill_unknown(PreparedFrames& frames) {
  for (Image<double>* picture : {&frames.reference, &frames.flow}) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < picture->size(); ++i) {
      if (frames.known.data()[i] == 0.0) continue;
      sum += picture->data()[i];
      count += 1.0;
    }
    double const mean = count > 0.0 ? sum / count : 0.0;
    for (std::size_t i = 0; i < picture->size(); ++i)
      if (frames.known.data()[i] == 0.0) picture->data()[i] = mean;
  }
}

}  // namespace

FramePreparation read_frame_preparation(SetupTable& correlate, PreparedSet set) {
  FramePreparation preparation;
  preparation.set = set;
  read_changes(correlate, "mask", masks, preparation.masks, preparation);
  read_changes(correlate, "preprocess", steps, preparation.steps, preparation);
  return preparation;
}

HostFrames prepare_frames(StoredFrames const& frames, FramePreparation const& preparation) {
  Image<double> const &reference = frames.reference(), &flow = frames.flow();
  GLADSTONE_EXPECTS(reference.columns() == flow.columns() && reference.rows() == flow.rows());
  PreparedFrames prepared{{reference, flow}, Image<double>(reference.columns(), reference.rows(), 1.0)};
  for (std::size_t i = 0; i < reference.size(); ++i)
    if (!std::isfinite(reference.data()[i]) || !std::isfinite(flow.data()[i])) prepared.known.data()[i] = 0.0;
  fill_unknown(prepared);
  for (FrameChange const& mask : preparation.masks) mask(prepared);
  fill_unknown(prepared);
  for (FrameChange const& step : preparation.steps) step(prepared);
  for (std::size_t i = 0; i < reference.size(); ++i)
    if (prepared.known.data()[i] == 0.0)
      prepared.reference.data()[i] = prepared.flow.data()[i] = std::numeric_limits<double>::quiet_NaN();
  return {std::move(prepared.reference), std::move(prepared.flow)};
}

double valid_pixel_fraction(StoredFrames const& frames) {
  Image<double> const& reference = frames.reference();
  auto const known = std::count_if(reference.begin(), reference.end(), [](double level) { return level == level; });
  return reference.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(reference.size());
}

}  // namespace gladstone
