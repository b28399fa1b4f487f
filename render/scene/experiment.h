#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/scene/source_kind.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline scene {

/// Kind of experiment: how its setup is read and checked, and what its scene contains. Setup::experiment() returns that
/// of a setup.
struct Experiment {
  char const* name;             ///< value of the key `experiment`
  SourceKind const& sources;    ///< light sources
  char const* focus_word;       ///< value of lens.focus for a lens in focus on the sources
  bool measures_density;        ///< true: the medium causes the displacement between the frames (Eq. 9)
  bool correlated;              ///< true: two frames, which are correlated; false: one frame for each plane
  bool medium_in_first_frame;   ///< true: both frames see the medium; false: the first frame is without medium
  bool consecutive_frames;      ///< pair k of a sequence: true: frames k and k + 1, k from 0; false: 0 and k, k from 1
  char const* reason_for_rays;  ///< reason against the fast renderer; empty: it may apply

  /// Reads the distance from the medium to the dots; refuses it for experiments without dots behind a medium.
  void (*read_z_d)(Setup& setup, SetupTable geometry);
  /// Reads the tables of the experiment, and refuses tables of other experiments.
  /// @param setup  camera, lens, elements, geometry and medium have been read
  void (*read)(Setup& setup, SetupTable root);
  /// Checks a setup whose lens forms an image across tables, see cross_check().
  void (*cross_check)(Setup const& setup, SetupTable root, Warnings& warnings);

  /// Returns the number of the first pair of a sequence.
  std::size_t first_pair() const { return consecutive_frames ? 0 : 1; }
};

extern Experiment const bos_experiment, piv_experiment, calibration_experiment;

/// All kinds of experiment, the default first. To add one, write its file in render/scene/experiments/ and add its name
/// above and here.
inline constexpr std::array all_experiments{&bos_experiment, &piv_experiment, &calibration_experiment};

/// Returns the experiment with a name; the default if there is none.
Experiment const& find_experiment(std::string const& name);

/// Returns the experiment that the key `experiment` of a setup names; the default if there is none.
Experiment const& find_experiment(SetupDocument const& setup);

/// Returns the kind that belongs to an experiment, among kinds or pointers to kinds; null if there is none.
template <class Kind, std::size_t count>
Kind const* find_kind(std::array<Kind, count> const& kinds, Experiment const& experiment) {
  for (Kind const& kind : kinds)
    if (&kind.experiment == &experiment) return &kind;
  return nullptr;
}
template <class Kind, std::size_t count>
Kind const* find_kind(std::array<Kind const*, count> const& kinds, Experiment const& experiment) {
  for (Kind const* kind : kinds)
    if (&kind->experiment == &experiment) return kind;
  return nullptr;
}

}  // namespace gladstone::inline scene
