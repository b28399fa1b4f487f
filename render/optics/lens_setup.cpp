#include "render/optics/lens_setup.h"

#include <fmt/format.h>

#include <cmath>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/paraxial.h"

namespace gladstone::inline optics {

LensSetup read_lens_setup(SetupTable table, std::string const& focus_on) {
  LensSetup setup;
  Range aperture = Range::positive();
  aperture.allow_inf = true;
  if (table.kind_word("model", "thin", {"thin", "prescription"}) == "prescription") {
    setup.file = table.required_path("file");
    // NaN: the stop is set by the prescription's own aperture, unless the setup gives an f-number
    setup.f_number = table.optional_number("f_number", aperture).value_or(std::nan(""));
    table.refuse("focal_length_mm", "conflicts with a prescription (which defines its own); remove it");
  } else {
    table.refuse("file", "names a prescription (the model is a thin lens); use model = \"prescription\"");
    setup.focal_length = table.quantity("focal_length_mm", setup.focal_length, unit::millimetre, Range::positive(1e5));
    setup.f_number = table.number("f_number", setup.f_number, aperture);
  }
  setup.glasses = table.path_list("glasses");
  if (table.has("focus_distance_mm")) {
    if (table.has("focus")) {
      table.problem("focus_distance_mm", "conflicts with focus (both set the plane in focus); remove one");
      table.word("focus", focus_on, {focus_on, "medium"});
    }
    setup.focus = Focus::distance;
    setup.focus_distance = table.number("focus_distance_mm", 1000.0, Range::positive()) * unit::millimetre;
  } else if (table.word("focus", focus_on, {focus_on, "medium"}) == "medium") {
    setup.focus = Focus::medium;
  }
  setup.transmittance = table.choice(
      "transmittance", setup.transmittance,
      {{"ideal", Transmittance::ideal}, {"surfaces", Transmittance::surfaces}, {"glass", Transmittance::glass}});
  setup.spot = table.choice("psf", setup.spot,
                            {{"gaussian", SpotModel::gaussian},
                             {"airy", SpotModel::airy},
                             {"gaussian_first_zero", SpotModel::gaussian_first_zero},
                             {"seed_eq8", SpotModel::seed_eq8},
                             {"none", SpotModel::none}});
  return setup;
}

GlassCatalogue read_glasses(LensSetup const& setup, SetupTable table) {
  GlassCatalogue glasses = GlassCatalogue::shipped();
  for (std::string const& file : setup.glasses) {
    try {
      glasses.add_file(file);
    } catch (DataError const& error) {
      table.problem("glasses", error.what(), error.code());
    }
  }
  return glasses;
}

void build_prescription(LensSetup& setup, SetupTable table, GlassCatalogue const& glasses, double wavelength,
                        std::optional<double> object_distance, Warnings& warnings) {
  LensOptions options;
  options.object_distance = object_distance;
  options.fresnel = setup.transmittance != Transmittance::ideal;
  options.absorption = setup.transmittance == Transmittance::glass;
  if (std::isfinite(setup.f_number)) options.f_number = setup.f_number;
  try {
    auto const lens =
        std::make_shared<Lens const>(build_lens(read_prescription(setup.file), glasses, wavelength, options));
    if (lens->object_index != 1 || std::abs(lens->paraxial.back().n_after) != 1) {
      std::string const& object_where = lens->prescription.object_medium.where;
      bool const in_object_space = lens->object_index != 1 && !object_where.empty();
      table.problem("file", fmt::format("{}: has index {:.6g} ahead of it and {:.6g} behind it (a lens must have air "
                                        "on both sides); end it with a surface towards air on either side",
                                        in_object_space ? object_where : setup.file, lens->object_index,
                                        std::abs(lens->paraxial.back().n_after)));
      return;
    }
    ParaxialLens const paraxial = paraxial_lens(*lens);
    setup.focal_length = std::abs(paraxial.effective_focal_length);
    if (std::isnan(setup.f_number) && std::isfinite(paraxial.f_number)) setup.f_number = paraxial.f_number;
    warnings.insert(warnings.end(), lens->warnings.begin(), lens->warnings.end());
    setup.prescription = lens;
  } catch (SetupError const& error) {
    for (SetupProblem const& one : error.problems()) table.problem("file", one.where + ": " + one.message, one.code);
  } catch (DataError const& error) {
    table.problem("file", error.what(), error.code());
  }
}

ImagingGeometry thin_lens_imaging(double focal_length, double f_number, double focus_distance, double target_distance) {
  double const image_distance = 1 / (1 / focal_length - 1 / focus_distance);
  return {image_distance, image_distance / target_distance, std::isinf(f_number) ? 0.0 : focal_length / f_number};
}

}  // namespace gladstone::inline optics
