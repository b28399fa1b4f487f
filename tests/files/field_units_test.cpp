#include "render/files/fields/field_units.h"

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
  for (char const* name : {"km", "kilometres"}) EXPECT_EQ(length_unit(name), 1e3) << name;
  for (char const* name : {"ft", "foot", "feet"}) EXPECT_EQ(length_unit(name), 0.3048) << name;
  for (char const* name : {"[mm]", "(mm)", "mm^1", " MM "}) EXPECT_EQ(length_unit(name), 1e-3) << name;
  EXPECT_EQ(length_unit("nm"), 1e-9);
  for (char const* name : {"", "1", "s", "ms", "kg/m^3", "pixels", "degrees_north", "furlong", "m^", "m2"})
    EXPECT_EQ(length_unit(name), 0.0) << name;
}

TEST(FieldUnits, SayWhatHadToBeAssumed) {
  EXPECT_THAT((FieldUnits{false, "", "", ""}.assumed()), HasSubstr("1 mm"));
  EXPECT_THAT((FieldUnits{true, "", "", ""}.assumed()), HasSubstr(" mm"));
  EXPECT_EQ((FieldUnits{true, "1", "", ""}.assumed()), (FieldUnits{true, "", "", ""}.assumed()));
  EXPECT_THAT((FieldUnits{true, "m", "", ""}.assumed()), IsEmpty());
  EXPECT_EQ((FieldUnits{true, "m", "", ""}.metres()), 1.0);
}

TEST(FieldUnits, UnknownUnitOfLengthLeavesTheSpacingUndefined) {
  FieldUnits const units{true, "ell", "", ""};
  EXPECT_THAT(units.undefined(), HasSubstr("\"ell\""));
  EXPECT_THAT(units.assumed(), IsEmpty());
  for (char const* known : {"", "1", "mm", "ft"}) EXPECT_THAT((FieldUnits{true, known, "", ""}.undefined()), IsEmpty());
}

TEST(FieldUnits, AreProductsWithExponents) {
  for (char const* unit : {"kg/m^3", "kg/m3", "kg m-3", "kg m^-3", "kg m**-3", "kg.m-3", "kg*m^-3", "Kg/M3",
                           "kg/m\u00b3", "kg m\u207b\u00b3", "[kg/m^3]", "g/l", "g L-1", "1 kg/m3"}) {
    EXPECT_NEAR(unit_size(unit, dimension_of_density).value_or(0), 1.0, 1e-12) << unit;
  }
  for (char const* unit : {"g/cm^3", "g cm-3", "g/cc", "kg/l", "Mg/m3", "1e3 kg/m^3"}) {
    EXPECT_NEAR(unit_size(unit, dimension_of_density).value_or(0), 1e3, 1e-9) << unit;
  }
  // NIST SP 811: 1 slug/ft^3 = 515.3788 kg/m^3
  EXPECT_NEAR(unit_size("slug/ft3", dimension_of_density).value_or(0), 515.3788, 1e-4);
  EXPECT_NEAR(unit_size("km/h", dimension_of_velocity).value_or(0), 1 / 3.6, 1e-12);
  EXPECT_NEAR(unit_size("mm/s", dimension_of_velocity).value_or(0), 1e-3, 1e-15);
  EXPECT_EQ(unit_size("1e-6", dimension_of_numbers), 1e-6);
  for (char const* unit : {"K", "Pa", "m/s", "kg", "kg/m^", "kg/m^99", "", "/", "1", "0 kg/m3", "\xff"}) {
    EXPECT_EQ(unit_size(unit, dimension_of_density), std::nullopt) << unit;
  }
}

TEST(FieldUnits, OfValuesAreConvertedOrReported) {
  auto const factor = [](std::string const& values) {
    return FieldUnits{true, "mm", values, ""}.value_factor(dimension_of_density);
  };
  EXPECT_NEAR(factor("g/cm^3").factor, 1e3, 1e-9);
  EXPECT_THAT(factor("g/cm^3").warning, IsEmpty());
  EXPECT_THAT(factor("1").warning, IsEmpty());
  EXPECT_EQ(factor("K").factor, 1);
  EXPECT_THAT(factor("K").warning, HasSubstr("\"K\""));
}

}  // namespace
}  // namespace gladstone
