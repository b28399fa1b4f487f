#pragma once

#include <optional>
#include <string>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/vectors/vector_file.h"

namespace gladstone::python {

/// Displacement vectors in our conventions, with the file or the measurement from which they come.
struct MeasuredField {
  DisplacementField field;
  std::string name = "field";                   ///< name for messages: path of the file, or "field"
  bool foreign = true;                          ///< true: from arrays or a file of another program; false: measured by
                                                ///< gladstone
  std::optional<CorrelationSettings> settings;  ///< settings of our measurement; nullopt: foreign
  std::string resolved;                         ///< settings as TOML; empty: foreign
  std::string device;                           ///< "cpu" or "cuda"; empty: foreign
  double seconds = 0;                           ///< wall time of the correlation [s]
  std::string reference_sha256, flow_sha256;    ///< SHA-256 hashes of the frames; empty: unknown
  bool complete = true;                         ///< false: the file's header declares a different number of vectors
};

}  // namespace gladstone::python
