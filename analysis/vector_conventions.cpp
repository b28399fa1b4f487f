#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/vector_file.h"

namespace gladstone {
namespace {

using Mirror = VectorConventions::Mirror;

bool same_axes(VectorConventions const& a, VectorConventions const& b) {
  return a.y_up == b.y_up && a.v_up == b.v_up && a.swapped == b.swapped && (!a.y_up || a.mirror == b.mirror);
}

/// Rms difference per component from the truth over a sample of the vectors; what exceeds 1 px counts as 1 px, and so
/// does a place without truth, lest a choice win by moving its vectors out of sight.
double score(DisplacementField const& field, VectorConventions const& conventions,
             std::function<Vec2d(Vec2d)> const& truth, int image_rows) {
  DisplacementField const ours = apply_conventions(field, conventions, image_rows);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours.counts(i)) continue;
    Vec2d const difference = ours.displacement_px[i] - truth(ours.position_px[i]);
    for (double const e : {difference.x, difference.y}) sum += std::isfinite(e) ? std::min(e * e, 1.0) : 1.0;
    count += 2;
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(sum / static_cast<double>(count));
}

/// At most `most` vectors that count, evenly taken, with the extreme rows kept so that the grid's middle stays.
DisplacementField sample(DisplacementField const& field, std::size_t most) {
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.counts(i) && std::isfinite(field.displacement_px[i].x) && std::isfinite(field.displacement_px[i].y)) {
      usable.push_back(i);
    }
  }
  std::size_t const stride = std::max<std::size_t>(1, (usable.size() + most - 1) / most);
  DisplacementField few;
  auto const take = [&](std::size_t i, VectorStatus status) {
    few.position_px.push_back(field.position_px[i]);
    few.displacement_px.push_back(field.displacement_px[i]);
    few.status.push_back(status);
  };
  for (std::size_t k = 0; k < usable.size(); k += stride) take(usable[k], VectorStatus::valid);
  auto const by_y = [&](std::size_t a, std::size_t b) { return field.position_px[a].y < field.position_px[b].y; };
  std::vector<std::size_t> all(field.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  if (!all.empty()) {
    auto const [low, high] = std::minmax_element(all.begin(), all.end(), by_y);
    take(*low, VectorStatus::masked);  // counts for the extent only
    take(*high, VectorStatus::masked);
  }
  return few;
}

}  // namespace

VectorConventions parse_conventions(std::string_view text, VectorConventions from) {
  VectorConventions conventions = from;
  while (!text.empty()) {
    std::size_t const end = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    constexpr std::string_view offset = "offset=";
    if (word == "y-down") {
      conventions.y_up = false;
    } else if (word == "y-up") {
      conventions.y_up = true;
      conventions.mirror = Mirror::grid;
    } else if (word == "y-up-image") {
      conventions.y_up = true;
      conventions.mirror = Mirror::image;
    } else if (word == "v-down" || word == "v-up") {
      conventions.v_up = word == "v-up";
    } else if (word == "swapped") {
      conventions.swapped = true;
    } else if (word.starts_with(offset)) {
      std::string_view const number = word.substr(offset.size());
      auto const [stop, error] = std::from_chars(number.data(), number.data() + number.size(), conventions.offset_px);
      if (error != std::errc{} || stop != number.data() + number.size() || !std::isfinite(conventions.offset_px)) {
        throw std::invalid_argument(fmt::format("conventions: {} is not offset=NUMBER, such as offset=-0.5", word));
      }
    } else {
      throw std::invalid_argument(fmt::format(
          "conventions: unknown word \"{}\"; use y-down, y-up, y-up-image, v-down, v-up, swapped, offset=NUMBER",
          word));
    }
  }
  return conventions;
}

std::string describe(VectorConventions const& conventions) {
  std::string_view const y = !conventions.y_up ? "y-down" : conventions.mirror == Mirror::grid ? "y-up" : "y-up-image";
  return fmt::format("{},{}{},offset={}", y, conventions.v_up ? "v-up" : "v-down",
                     conventions.swapped ? ",swapped" : "", conventions.offset_px);
}

DisplacementField apply_conventions(DisplacementField field, VectorConventions const& conventions, int image_rows) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (Vec2d& p : field.position_px) {
    p += Vec2d{conventions.offset_px, conventions.offset_px};
    if (!std::isfinite(p.y)) continue;
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  if (conventions.y_up) {
    double const mirror = conventions.mirror == Mirror::grid ? low + high : image_rows - 1.0;
    for (Vec2d& p : field.position_px) p.y = mirror - p.y;
  }
  double const u_sign = conventions.swapped ? -1.0 : 1.0;
  double const v_sign = conventions.v_up ? -u_sign : u_sign;
  for (Vec2d& d : field.displacement_px) d = {u_sign * d.x, v_sign * d.y};
  arrange_as_grid(field);
  return field;
}

DetectedConventions detect_conventions(VectorFile const& file, std::function<Vec2d(Vec2d)> const& truth,
                                       int image_rows) {
  DisplacementField const few = sample(file.field, 4000);
  double const own_offset = file.conventions.offset_px;

  // Every choice, the format's own first, so that it wins a tie.
  struct Choice {
    VectorConventions conventions;
    double score_px;
  };
  std::vector<Choice> choices;
  auto const consider = [&](VectorConventions const& c) {
    bool const known = std::any_of(choices.begin(), choices.end(), [&](Choice const& o) { return o.conventions == c; });
    if (!known) choices.push_back({c, score(few, c, truth, image_rows)});
  };
  for (double const offset : {own_offset, 0.0, -0.5, -1.0, -1.5}) {
    VectorConventions own = file.conventions;
    own.offset_px = offset;
    consider(own);
    for (bool const swapped : {false, true}) {
      for (bool const v_up : {false, true}) {
        consider({false, v_up, swapped, offset, Mirror::grid});
        consider({true, v_up, swapped, offset, Mirror::grid});
        consider({true, v_up, swapped, offset, Mirror::image});
      }
    }
  }

  // Axes and sign by the best score; the offset stays the format's own unless another is clearly better.
  auto const better = [](Choice const& a, Choice const& b) { return a.score_px < b.score_px; };
  Choice const best_overall = *std::min_element(choices.begin(), choices.end(), better);
  auto const with_offset = [&](VectorConventions c, double offset) {
    c.offset_px = offset;
    return *std::find_if(choices.begin(), choices.end(), [&](Choice const& o) { return o.conventions == c; });
  };
  Choice chosen = with_offset(best_overall.conventions, own_offset);
  bool const moved = best_overall.score_px < 0.95 * chosen.score_px;
  if (moved) chosen = best_overall;

  DetectedConventions result;
  result.runner_up_px = std::numeric_limits<double>::infinity();
  VectorConventions rival;
  for (Choice const& choice : choices) {
    if (same_axes(choice.conventions, chosen.conventions) || !(choice.score_px < result.runner_up_px)) continue;
    // Mirrored about the grid or about the image is a matter of position, like the offset, not of axes.
    if (choice.conventions.y_up && chosen.conventions.y_up && choice.conventions.v_up == chosen.conventions.v_up &&
        choice.conventions.swapped == chosen.conventions.swapped) {
      continue;
    }
    result.runner_up_px = choice.score_px;
    rival = choice.conventions;
  }
  result.ambiguous = !(chosen.score_px < 0.9 * result.runner_up_px);
  if (result.ambiguous) {
    VectorConventions const& own = file.conventions;
    Choice const fallback = with_offset(own, own_offset);
    if (!(fallback.score_px > 1.1 * chosen.score_px)) chosen = fallback;
  }
  result.conventions = chosen.conventions;
  result.score_px = chosen.score_px;
  result.report =
      fmt::format("{} vectors read as {} ({:.3f} px rms from the truth; next best {}: {:.3f} px)", file.format,
                  describe(chosen.conventions), chosen.score_px, describe(rival), result.runner_up_px);
  if (result.ambiguous) result.report += "; ambiguous: say which with --conventions";
  return result;
}

}  // namespace gladstone
