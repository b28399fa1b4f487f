#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/sweep/study_table.h"

namespace gladstone::inline sweep {

/// A point of a study in a ranking.
struct RankedPoint {
  std::size_t row = 0;  ///< row of the point's first case
  double value = 0;     ///< mean of the measure over the finished repeats
};

/// Points of a study in ascending order of one measure of the error. Points without a known value are omitted.
struct StudyRanking {
  std::string measure;
  std::string meaning;
  std::vector<RankedPoint> points;
};

/// Returns the measure of the measurement error that the finished cases have: "eq9.rms_px" (BOS), "flow.rms_px" (PIV),
/// else "ray_truth.rms_px".
std::string main_error_measure(StudyTable const& table);

/// Ranks the points by the error in pixels, by the error over the signal, and by the error of the density gradient, as
/// far as they are known. The error in pixels alone favours set-ups of low sensitivity, whose signal is also small.
std::vector<StudyRanking> rank_points(StudyTable const& table);

/// Returns the varied axes of a row with their values, "lens.f_number = 8, ..."; empty if no axis varies.
std::string point_title(StudyTable const& table, StudyRow const& row);

/// Formats the best three points of every ranking.
std::string ranking_text(StudyTable const& table, std::vector<StudyRanking> const& rankings);
/// Returns an array of {measure, meaning, points: [{case, value}]}, with all points.
nlohmann::ordered_json ranking_json(StudyTable const& table, std::vector<StudyRanking> const& rankings);

}  // namespace gladstone::inline sweep
