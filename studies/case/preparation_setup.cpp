#include "studies/case/preparation_setup.h"

#include <algorithm>
#include <array>
#include <memory>

#include "analysis/preparation/frame_changes.h"

namespace gladstone::inline cases {
namespace {

/// Preparation that is being read from the setup, and the set of frames to which it applies.
struct ReadPreparation {
  FramePreparation& preparation;
  PreparedSet set;
};

/// `x_px`, `y_px`: corners of a polygon.
FrameChange read_polygon(SetupTable& table, ReadPreparation) {
  constexpr std::size_t fewest = 3, most = 10000;
  std::vector<double> const x = table.number_list("x_px", {}, fewest, most);
  std::vector<double> const y = table.number_list("y_px", {}, fewest, most);
  for (char const* key : {"x_px", "y_px"})
    if (!table.has(key))
      table.problem(key, "is missing (a polygon requires corners); give three or more numbers", ErrorCode::missing_key);
  if (!x.empty() && !y.empty() && x.size() != y.size())
    table.problem("y_px", "has another number of values than x_px (each corner has both coordinates); give as many");
  std::vector<Vec2d> corners;
  for (std::size_t k = 0; k < std::min(x.size(), y.size()); ++k) corners.push_back({x[k], y[k]});
  return make_polygon_mask(corners);
}

/// `file`: image of the size of the frames.
FrameChange read_mask_image(SetupTable& table, ReadPreparation read) {
  std::string const file = table.required_path("file");
  if (!file.empty()) read.preparation.files.push_back(file);
  return make_image_mask(file);
}

/// `above_dn`, `below_dn`: limits of the grey level; `blur_px`: standard deviation of the filter.
FrameChange read_intensity(SetupTable& table, ReadPreparation) {
  std::optional<double> const above = table.optional_number("above_dn"), below = table.optional_number("below_dn");
  double const blur_px = table.number("blur_px", 0.0, Range::at_least(0.0, 512.0));
  if (!table.has("above_dn") && !table.has("below_dn"))
    table.problem("kind",
                  "\"intensity\" requires a level (otherwise nothing is masked); give above_dn, below_dn or both");
  if (above && below && *below > *above)
    table.problem("below_dn", "exceeds above_dn (everything would be masked); exchange them");
  return make_intensity_mask(above, below, blur_px);
}

/// `subtract`: statistic; `frame`: tables with the files of `reference` and `flow`. If `frame` is missing, the
/// background is that of the sequence.
FrameChange read_background_step(SetupTable& table, ReadPreparation read) {
  std::string const statistic = table.word("subtract", "minimum", background_statistics());
  std::vector<SetupTable> frames = table.tables("frame");
  if (frames.empty() && read.set == PreparedSet::sequence) {
    auto const own = std::make_shared<SequenceBackground>();
    own->statistic = statistic;
    read.preparation.backgrounds.push_back(own);
    return make_background_subtraction(own);
  }
  if (frames.empty())
    table.problem("frame",
                  "is missing (a background requires a sequence); give frame = [{ reference = \"a.tif\", flow = "
                  "\"b.tif\" }, ...]",
                  ErrorCode::missing_key);
  std::vector<std::string> reference, flow;
  for (SetupTable& pair : frames) {
    reference.push_back(pair.required_path("reference"));
    flow.push_back(pair.required_path("flow"));
  }
  for (auto const* files : {&reference, &flow})
    read.preparation.files.insert(read.preparation.files.end(), files->begin(), files->end());
  return make_background_subtraction(statistic, reference, flow);
}

FrameChange read_high_pass(SetupTable& table, ReadPreparation) {
  return make_high_pass(table.number("sigma_px", 10.0, Range::positive(512.0)));
}

FrameChange read_clahe(SetupTable& table, ReadPreparation) {
  int const tile_px = static_cast<int>(table.integer("tile_px", 64, 4, 4096));
  return make_clahe(tile_px, table.number("clip_limit", 2.0, Range::at_least(1.0, 1e6)));
}

FrameChange read_intensity_cap(SetupTable& table, ReadPreparation) {
  return make_intensity_cap(table.number("deviations", 2.0, Range::positive()));
}

FrameChange read_min_max(SetupTable& table, ReadPreparation) {
  int const window_px = static_cast<int>(table.integer("window_px", 15, 3, 511));
  return make_min_max(window_px, table.number("least_contrast", 0.05, Range::positive(1.0)));
}

struct NamedChange {
  char const* name;
  FrameChange (*read)(SetupTable& table, ReadPreparation read);
};

/// All masks.
constexpr std::array mask_kinds{
    NamedChange{"polygon", read_polygon},
    NamedChange{"image", read_mask_image},
    NamedChange{"intensity", read_intensity},
};

/// All preprocessing steps.
constexpr std::array step_kinds{
    NamedChange{"background", read_background_step},
    NamedChange{"high_pass", read_high_pass},
    NamedChange{"clahe", read_clahe},
    NamedChange{"intensity_cap", read_intensity_cap},
    NamedChange{"min_max", read_min_max},
};

/// Reads an array of masks or steps.
template <class Kinds>
std::vector<FrameChange> read_changes(SetupTable& correlate, std::string const& key, Kinds const& kinds,
                                      ReadPreparation read) {
  std::vector<std::string> names;
  for (NamedChange const& kind : kinds) names.emplace_back(kind.name);
  std::string quoted_names;
  for (std::string const& name : names) quoted_names += (quoted_names.empty() ? "\"" : ", \"") + name + '"';
  std::vector<FrameChange> changes;
  for (SetupTable& table : correlate.tables(key)) {
    std::string const word = table.kind_word("kind", "", names);  // "" if the value was rejected
    if (!table.has("kind")) {
      table.problem("kind", "is missing; give " + quoted_names, ErrorCode::missing_key);
      table.suppress_unread_keys();
    }
    for (NamedChange const& kind : kinds)
      if (word == kind.name) changes.push_back(kind.read(table, read));
  }
  return changes;
}

}  // namespace

FramePreparation read_frame_preparation(SetupTable& correlate, PreparedSet set) {
  FramePreparation preparation;
  preparation.masks = read_changes(correlate, "mask", mask_kinds, {preparation, set});
  preparation.steps = read_changes(correlate, "preprocess", step_kinds, {preparation, set});
  return preparation;
}

}  // namespace gladstone::inline cases
