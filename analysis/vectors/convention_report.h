#pragma once

#include <string>

#include "analysis/vectors/convention_detection.h"

namespace gladstone::inline vectors {

/// Returns the report for vectors that no convention fits: the tried interpretations and the probable cause.
std::string misfit_report(VectorFile const& file, DetectedConventions const& detected);

/// Returns one line about the conventions in use, their fit, and the best other interpretation.
std::string found_report(VectorFile const& file, DetectedConventions const& detected);

/// Describes the difference between an interpretation and the format's own as a mistake: "v points up", "the frames
/// were exchanged".
std::string describe_difference(VectorConventions const& reading, VectorConventions const& own);

/// Returns a message on whether the offset of the conventions improves the fit, such as "x - 0.5 px fits better: rms
/// 0.0021 instead of 0.0050 px"; empty for offset 0.
std::string offset_report(DetectedConventions const& detected);

}  // namespace gladstone::inline vectors
