#include "render/files/hdf5_objects.h"

#include <hdf5.h>

#include "render/base/error.h"

namespace gladstone::inline files::hdf5 {
namespace {

/// Returns a dataspace of one value, which is created once.
hid_t scalar_space() {
  static hid_t const space = H5Screate(H5S_SCALAR);
  return space;
}

/// Returns the type of texts, which is created once. Texts are stored outside the object header, which is limited to
/// 64 KiB.
hid_t text_type() {
  static hid_t const text = [] {
    hid_t const type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return type;
  }();
  return text;
}

}  // namespace

void check(bool good, std::string const& path, std::string const& what) {
  if (!good) throw OutputError(path, what + " cannot be written to the file (out of memory?)");
}

void write_attribute(hid_t object, std::string const& path, std::string const& name, hid_t type, void const* value) {
  Id const created(H5Acreate2(object, name.c_str(), type, scalar_space(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(created.valid() && H5Awrite(created, type, value) >= 0, path, "attribute \"" + name + '"');
}

void write_attribute(hid_t object, std::string const& path, std::string const& name, std::string const& value) {
  char const* const text = value.c_str();
  write_attribute(object, path, name, text_type(), &text);
}

Id open_object(hid_t file, std::string const& path, std::string const& object, std::string const& attribute) {
  Id opened(H5Oopen(file, object.c_str(), H5P_DEFAULT), H5Oclose);
  check(opened.valid(), path, "attribute \"" + attribute + "\" of \"" + object + '"');
  if (H5Aexists(opened, attribute.c_str()) > 0) H5Adelete(opened, attribute.c_str());
  return opened;
}

void make_groups(hid_t file, std::string const& path, std::string const& dataset) {
  auto parts = steps(dataset);
  parts.pop_back();
  std::string group;
  for (auto const& part : parts) {
    group += '/' + part;
    if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
    Id const properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    H5Pset_obj_track_times(properties, false);
    Id const made(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose);
    check(made.valid(), path, "group \"" + group + '"');
  }
}

}  // namespace gladstone::inline files::hdf5
