#include "render/base/fields/field_units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gladstone {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(FieldUnits, AreKnownByTheirUsualNames) {
  for (char const* name : {"m", "metre", "Metres", "meter", "meters"}) EXPECT_EQ(length_unit(name), 1.0) << name;
  for (char const* name : {"mm", "millimetres", "Millimeter"}) EXPECT_EQ(length_unit(name), 1e-3) << name;
  for (char const* name : {"um", "\u00b5m", "\u03bcm", "micron", "microns", "micrometers"}) {
    EXPECT_EQ(length_unit(name), 1e-6) << name;
  }
  EXPECT_EQ(length_unit("cm"), 1e-2);
  for (char const* name : {"in", "inch", "inches"}) EXPECT_EQ(length_unit(name), 0.0254) << name;
  for (char const* name : {"", "1", "s", "ms", "kg/m^3", "pixels"}) EXPECT_EQ(length_unit(name), 0.0) << name;
}

TEST(FieldUnits, SayWhatHadToBeAssumed) {
  EXPECT_THAT((FieldUnits{false, "", "", ""}.assumed()), HasSubstr("1 mm apart"));
  EXPECT_THAT((FieldUnits{true, "", "", ""}.assumed()), HasSubstr("no unit and are taken as mm"));
  EXPECT_THAT((FieldUnits{true, "ell", "", ""}.assumed()), HasSubstr("\"ell\""));
  EXPECT_THAT((FieldUnits{true, "m", "", ""}.assumed()), IsEmpty());
  EXPECT_EQ((FieldUnits{true, "m", "", ""}.metres()), 1.0);
  EXPECT_EQ((FieldUnits{true, "ell", "", ""}.metres()), 1e-3);
}

}  // namespace
}  // namespace gladstone
