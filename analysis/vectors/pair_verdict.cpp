#include "analysis/vectors/pair_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace gladstone::inline vectors {
namespace {

using Kind = PairVerdict::Kind;

struct Words {
  Kind kind;
  char const* code;
  char const* text;  ///< with a place for PairVerdict::number, if the kind has one
};

constexpr std::array all_words{
    Words{Kind::not_tested, "", ""},
    Words{Kind::correlates, "correlates", "correlates"},
    Words{Kind::uncorrelated, "uncorrelated", "does not correlate"},
    Words{Kind::identical_frames, "identical_frames", "not judged: both frames are the same image"},
    Words{Kind::masked, "masked", "not judged: all windows are masked"},
    Words{Kind::no_signal, "no_signal", "not judged: no window has a signal"},
    Words{Kind::optical_flow, "optical_flow", "not judged: optical flow has no correlation"},
    Words{Kind::few_windows, "few_windows", "not judged: there are fewer than {:.0f} windows"},
    Words{Kind::no_median_test, "no_median_test",
          "not judged: correlate.median_threshold = \"off\" does not reject spurious vectors"},
    Words{Kind::periodic, "periodic", "not judged: the pattern repeats every {:.2f} px"},
    Words{Kind::no_valid_vector, "no_valid_vector", "not judged: no vector passed its tests"},
};

Words const& words_of(Kind kind) {
  return *std::find_if(all_words.begin(), all_words.end(), [kind](Words const& words) { return words.kind == kind; });
}

}  // namespace

std::string_view verdict_code(Kind kind) { return words_of(kind).code; }

Kind find_verdict_kind(std::string_view code) {
  auto const found =
      std::find_if(all_words.begin(), all_words.end(), [code](Words const& words) { return words.code == code; });
  return found == all_words.end() ? Kind::not_tested : found->kind;
}

PairVerdict find_verdict(std::string_view text) {
  for (Words const& words : all_words) {
    std::string_view const pattern = words.text, prefix = pattern.substr(0, pattern.find('{'));
    if (!text.starts_with(prefix)) continue;
    std::string const number(text.substr(prefix.size()));
    PairVerdict const verdict{words.kind, prefix == pattern ? 0.0 : std::strtod(number.c_str(), nullptr)};
    if (verdict_text(verdict) == text) return verdict;
  }
  return {};
}

std::string verdict_text(PairVerdict const& verdict) {
  return fmt::format(fmt::runtime(words_of(verdict.kind).text), verdict.number);
}

}  // namespace gladstone::inline vectors
