#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/ideal_images/pair_batch.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline cases {

/// Setup of one camera of which pairs of ideal particle images are rendered in batches, each pair with other values of
/// some keys. Its functions may be called from several threads at once.
class PairSource {
 public:
  /// Reads and checks the setup and opens the device.
  /// @param name    name of the setup in messages
  /// @param device  "cpu", "cuda", or "auto": a GPU if one is usable
  /// @throws SetupError, DeviceError, DataError if pairs of the setup cannot be rendered in batches
  PairSource(SetupDocument document, std::string const& name, std::string const& device);

  /// Replaced keys of one pair: assignments "key.path=value" in TOML, applied in this order.
  using Changes = std::vector<std::string>;

  /// Builds the models of pairs, on several threads. A pair whose changes replace numbers of [flow] by numbers requires
  /// this table to be read only; for other changes, the setup is read completely.
  /// @param changes  one element per pair
  /// @throws SetupError, DataError
  std::vector<OwnedPairModel> build_models(std::vector<Changes> const& changes) const;

  /// Opens a renderer of pairs with these models on the device.
  std::unique_ptr<PairBatchRenderer> open(std::vector<OwnedPairModel> const& models) const;

 private:
  OwnedPairModel build_model(Changes const& changes) const;

  SetupDocument document_;
  std::string name_;
  Setup setup_;
  bool on_gpu_;
};

}  // namespace gladstone::inline cases
