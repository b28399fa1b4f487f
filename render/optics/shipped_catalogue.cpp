#include "render/optics/shipped_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "render/base/contracts.h"
#include "render/optics/agf.h"
#include "render/optics/glass_name.h"
#include "render/optics/shipped_glasses.h"

namespace gladstone::inline optics {

ShippedCatalogue const& ShippedCatalogue::instance() {
  static ShippedCatalogue const catalogue;
  return catalogue;
}

ShippedCatalogue::ShippedCatalogue() {
  std::vector<ShippedText> texts = shipped_glasses();
  std::stable_sort(texts.begin(), texts.end(), [](ShippedText const& a, ShippedText const& b) {
    return maker_rank(glass_key(a.name)) < maker_rank(glass_key(b.name));
  });
  for (ShippedText const& text : texts) {
    catalogues_.push_back({glass_key(text.name), fmt::format("data/glasses/{}.agf", text.name)});
    int line = 1;
    for (std::string_view const part : text.parts) line = add_entries(part, line);
  }
  glasses_.resize(entries_.size());
}

int ShippedCatalogue::add_entries(std::string_view text, int first_line) {
  int line = first_line;
  std::size_t begin = std::string_view::npos;  // lines of the glass that is being read
  auto const end_glass = [&](std::size_t end) {
    if (begin != std::string_view::npos) entries_.back().text = text.substr(begin, end - begin);
  };
  for (std::size_t at = 0; at < text.size(); ++line) {
    if (text.substr(at).starts_with("NM ")) {
      end_glass(at);
      begin = at;
      std::size_t const name = at + 3;
      std::string_view const word = text.substr(name, text.find(' ', name) - name);
      entries_.push_back({glass_key(word), word, {}, catalogues_.size() - 1, line});
    }
    at = std::min(text.find('\n', at), text.size() - 1) + 1;
  }
  end_glass(text.size());
  return line;
}

Glass ShippedCatalogue::read(Entry const& entry) const {
  Catalogue const& catalogue = catalogues_[entry.catalogue];
  AgfContent content = read_agf(entry.text, catalogue.name, entry.line);
  GLADSTONE_EXPECTS(content.glasses.size() == 1);
  Glass glass = std::move(content.glasses.front());
  glass.where = fmt::format("{}:{}", catalogue.file, glass.where);
  return glass;
}

Glass const& ShippedCatalogue::glass(std::size_t entry) const {
  std::lock_guard const lock(mutex_);
  std::unique_ptr<Glass const>& slot = glasses_[entry];
  if (!slot) slot = std::make_unique<Glass const>(read(entries_[entry]));
  return *slot;
}

}  // namespace gladstone::inline optics
