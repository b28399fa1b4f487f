#include "studies/commands/field_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gladstone {
namespace {

/// A field without a file: v = 1 everywhere, and 4 at one node.
class OneNode final : public FieldSource {
 public:
  OneNode(std::array<int, 3> nodes, std::array<int, 3> node) : FieldSource(1), node_(node) {
    grid_.nodes = nodes;
    grid_.spacing = {1.0, 0.5, 0.25};
  }
  RegularGrid const& grid() const override { return grid_; }
  FieldUnits const& units() const override { return units_; }
  std::string const& name() const override { return name_; }
  AxisAssignment const& reading() const override { return reading_; }
  Warnings notes() override { return {}; }
  int significant_bits() const override { return 53; }
  void read_planes(int, int, std::span<double>) override {
    FAIL() << "the statistics must read rows, not whole planes";
  }
  void read_rows(int plane, int first_row, int count, std::span<double> out) override {
    most_ = std::max(most_, out.size());
    std::fill(out.begin(), out.end(), 1.0);
    if (plane != node_[2] || node_[1] < first_row || node_[1] >= first_row + count) return;
    out[static_cast<std::size_t>(node_[1] - first_row) * static_cast<std::size_t>(grid_.nodes[0]) +
        static_cast<std::size_t>(node_[0])] = 4.0;
  }
  /// Largest number of values requested at once.
  std::size_t most() const { return most_; }

 private:
  RegularGrid grid_;
  FieldUnits units_;
  AxisAssignment reading_;
  std::string name_ = "one node";
  std::array<int, 3> node_;
  std::size_t most_ = 0;
};

// Planes of 9 Mi values are read in three blocks of at most four rows. The node is in the first row of a block, in the
// last one, or in between: its neighbours in the next block are found in all cases.
TEST(FieldStatistics, OfPlanesTooLargeToBeHeldAreThoseOfTheWhole) {
  for (int const row : {3, 4, 8}) {
    OneNode field({1 << 20, 9, 2}, {1000, row, 1});
    FieldStatistics const seen = field_statistics(field).front();
    EXPECT_EQ(seen.minimum, 1.0);
    EXPECT_EQ(seen.maximum, 4.0);
    EXPECT_EQ(seen.steepest.x, 3.0);
    EXPECT_EQ(seen.steepest.y, 6.0);
    EXPECT_EQ(seen.steepest.z, 12.0);
    EXPECT_LE(field.most(), std::size_t{5} << 20);
  }
}

// Neighbours in y only, across two blocks: the node is in the last row of a block, and a plane has no neighbour along
// z.
TEST(FieldStatistics, OfASinglePlane) {
  OneNode field({1 << 20, 9, 1}, {0, 3, 0});
  FieldStatistics const seen = field_statistics(field).front();
  EXPECT_EQ(seen.steepest.x, 3.0);
  EXPECT_EQ(seen.steepest.y, 6.0);
  EXPECT_EQ(seen.steepest.z, 0.0);
}

/// A velocity (x, -2 y, 3) on 3 x 2 x 2 nodes, of indices x, y, z.
class LinearVelocity final : public FieldSource {
 public:
  LinearVelocity() : FieldSource(3) {
    grid_.nodes = {3, 2, 2};
    grid_.spacing = {1.0, 0.5, 0.25};
  }
  RegularGrid const& grid() const override { return grid_; }
  FieldUnits const& units() const override { return units_; }
  std::string const& name() const override { return name_; }
  AxisAssignment const& reading() const override { return reading_; }
  Warnings notes() override { return {}; }
  int significant_bits() const override { return 53; }
  void read_planes(int plane, int, std::span<double> out) override { read_rows(plane, 0, grid_.nodes[1], out); }
  void read_rows(int, int first_row, int, std::span<double> out) override {
    for (std::size_t i = 0; i < out.size(); i += 3) {
      out[i] = static_cast<double>(i / 3 % 3);
      out[i + 1] = -2.0 * static_cast<double>(static_cast<std::size_t>(first_row) + i / 9);
      out[i + 2] = 3.0;
    }
  }

 private:
  RegularGrid grid_;
  FieldUnits units_;
  AxisAssignment reading_;
  std::string name_ = "velocity";
};

TEST(FieldStatistics, OfAVelocityAreThoseOfEachComponent) {
  LinearVelocity field;
  std::vector<FieldStatistics> const seen = field_statistics(field);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0].minimum, 0.0);
  EXPECT_EQ(seen[0].maximum, 2.0);
  EXPECT_EQ(seen[0].steepest, (Vec3d{1, 0, 0}));
  EXPECT_EQ(seen[1].minimum, -2.0);
  EXPECT_EQ(seen[1].maximum, 0.0);
  EXPECT_EQ(seen[1].steepest, (Vec3d{0, 4, 0}));
  EXPECT_EQ(seen[2].minimum, 3.0);
  EXPECT_EQ(seen[2].maximum, 3.0);
  EXPECT_EQ(seen[2].steepest, (Vec3d{0, 0, 0}));
}

}  // namespace
}  // namespace gladstone
