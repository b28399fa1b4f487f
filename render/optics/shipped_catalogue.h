#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "render/optics/glass.h"

namespace gladstone::inline optics {

/// Glasses of the catalogues in data/glasses. At first only their names are read; a glass is read when it is first
/// used. Usable by several threads at once.
class ShippedCatalogue {
 public:
  struct Entry {
    std::string key;            ///< name of the glass as a key, see glass_key()
    std::string_view name;      ///< name of the glass
    std::string_view text;      ///< lines of the glass
    std::size_t catalogue = 0;  ///< index of the catalogue of the glass
    int line = 0;               ///< number of its first line in the catalogue
  };

  static ShippedCatalogue const& instance();

  /// Returns one entry per glass: manufacturers in the order of maker_rank(), the glasses of each as in its file.
  std::vector<Entry> const& entries() const { return entries_; }
  /// Returns the name of the catalogue that contains an entry, as a key.
  std::string const& catalogue(Entry const& entry) const { return catalogues_[entry.catalogue].name; }
  /// Returns the glass of an entry by its index. References remain valid.
  Glass const& glass(std::size_t entry) const;

 private:
  struct Catalogue {
    std::string name;
    std::string file;
  };
  ShippedCatalogue();
  /// Adds the glasses of a part of the latest catalogue. @return number of the line behind it
  int add_entries(std::string_view text, int first_line);
  Glass read(Entry const& entry) const;

  std::vector<Catalogue> catalogues_;
  std::vector<Entry> entries_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Glass const>> glasses_;  ///< glasses by index of the entry; null until the glass
                                                               ///< is used
};

}  // namespace gladstone::inline optics
