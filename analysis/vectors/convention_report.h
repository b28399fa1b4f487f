#pragma once

#include <string>

#include "analysis/vectors/convention_detection.h"

/// The words for conventions of vectors and for mistakes in them.
namespace gladstone::inline vectors {

/// Reports the conventions in use, their fit, and the best other interpretation in one line; for vectors that no
/// convention fits, the tried interpretations and the probable cause.
std::string convention_report(DetectedConventions const& detected);

/// Describes the difference between an interpretation and the format's own as a mistake: "v points up", "the frames
/// were exchanged".
std::string describe_difference(VectorConventions const& reading, VectorConventions const& own);

/// Describes a reason: "v points up and displacements are 10 times the truth, as if in another unit than px".
std::string describe_reason(MistakeReason const& reason);

/// Describes all reasons of a mistake: "v points up, or the frames were exchanged"; empty without a mistake.
std::string describe_mistake(ProbableMistake const& mistake);

/// Returns a warning with the reasons, both rms differences and the remedy.
std::string mistake_warning(ProbableMistake const& mistake);

/// Returns a message on whether the offset of the conventions improves the fit, such as "x - 0.5 px fits better: rms
/// 0.0021 instead of 0.0050 px"; empty for offset 0.
std::string offset_report(DetectedConventions const& detected);

}  // namespace gladstone::inline vectors
