#include <hdf5.h>

#include <array>
#include <bit>
#include <cstring>

#include "tests/fuzz/hdf5_readers.h"

using namespace gladstone;

namespace {

/// The input as a supply of small numbers; behind its end there are only zeros.
class Supply {
 public:
  explicit Supply(std::string_view bytes) : bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  std::size_t below(std::size_t count) { return static_cast<unsigned char>(next()) % count; }
  /// Small whole numbers for the most part, now and then any eight bytes.
  double number() {
    std::size_t const what = below(256);
    if (what < 255) return static_cast<double>(what) - 8;
    std::array<char, 8> raw;
    for (char& byte : raw) byte = next();
    return std::bit_cast<double>(raw);
  }

 private:
  char next() {
    if (bytes_.empty()) return 0;
    char const byte = bytes_.front();
    bytes_.remove_prefix(1);
    return byte;
  }
  std::string_view bytes_;
};

constexpr std::array names{"xcoor",
                           "ycoor",
                           "zcoor",
                           "density_0001",
                           "u00000",
                           "x_px",
                           "y_px",
                           "u_px",
                           "v_px",
                           "sigma_u_px",
                           "sigma_v_px",
                           "peak_ratio",
                           "status",
                           "dots/position_m",
                           "dots/reference_px",
                           "dots/displacement_px",
                           "dots/displacement_std_px",
                           "dots/flux",
                           "dots/eq9_px",
                           "dots/chief_px",
                           "dots/eq9_cone_px",
                           "dots/rays",
                           "field/spacing_px",
                           "field/density_kg_m3",
                           "field/density_gradient_kg_m4",
                           "field/eq9_px",
                           "dots/displacement_error_px",
                           "dots/by_table",
                           "particles/position_m",
                           "particles/reference_px",
                           "particles/displacement_px",
                           "particles/displacement_error_px",
                           "particles/displacement_std_px",
                           "particles/reference_ambient_px",
                           "particles/displacement_ambient_px",
                           "particles/flux",
                           "particles/diameter_m",
                           "particles/rays"};

/// A type on disk: numbers for the most part. The caller closes it.
hid_t stored_type(std::size_t choice) {
  switch (choice) {
    case 0:
      return H5Tcopy(H5T_IEEE_F32LE);
    case 1:
      return H5Tcopy(H5T_STD_I64LE);
    case 2:
      return H5Tcopy(H5T_STD_U8LE);
    case 3:
      return H5Tcopy(H5T_STD_U64BE);
    case 4: {
      hid_t const text = H5Tcopy(H5T_C_S1);
      H5Tset_size(text, 8);
      return text;
    }
    case 5: {
      hid_t const pair = H5Tcreate(H5T_COMPOUND, 8);
      H5Tinsert(pair, "value", 0, H5T_IEEE_F64LE);
      return pair;
    }
    default:
      return H5Tcopy(H5T_IEEE_F64LE);
  }
}

void write_dataset(hid_t file, Supply& supply) {
  char const* const name = names[supply.below(names.size())];
  std::vector<hsize_t> shape(supply.below(6));
  for (hsize_t& size : shape) size = supply.below(10);
  hid_t const type = stored_type(supply.below(12));
  hid_t const links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  hid_t const space =
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  hid_t const properties = H5Pcreate(H5P_DATASET_CREATE);
  if (supply.below(4) == 1 && !shape.empty() && H5Sget_simple_extent_npoints(space) > 0) {
    H5Pset_chunk(properties, static_cast<int>(shape.size()), shape.data());
    H5Pset_deflate(properties, 1);
  }
  hid_t const dataset = H5Dcreate2(file, name, type, space, links, properties, H5P_DEFAULT);
  if (dataset >= 0) {
    std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    bool const numbers = H5Tget_class(type) == H5T_FLOAT || H5Tget_class(type) == H5T_INTEGER;
    for (double& value : values) value = supply.number();
    if (!values.empty()) {
      H5Dwrite(dataset, numbers ? H5T_NATIVE_DOUBLE : type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Dclose(dataset);
  }
  H5Pclose(properties);
  H5Sclose(space);
  H5Pclose(links);
  H5Tclose(type);
}

/// Writes the attribute "setup", in which our files store a text.
void write_attribute(hid_t file, Supply& supply) {
  hid_t const type = stored_type(supply.below(12));
  hsize_t const count = supply.below(3);
  hid_t const space = H5Screate_simple(1, &count, nullptr);
  hid_t const attribute = H5Acreate2(file, "setup", type, space, H5P_DEFAULT, H5P_DEFAULT);
  std::array<double, 2> const values{supply.number(), supply.number()};
  if (attribute >= 0) {
    H5Awrite(attribute, type, values.data());
    H5Aclose(attribute);
  }
  H5Sclose(space);
  H5Tclose(type);
}

}  // namespace

// An HDF5 file that is whole, but holds datasets of any names, shapes, types and values that the input asks for.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::string const path = fuzz::file_of("", "datasets.h5");
  hid_t const file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  Supply supply(input);
  write_attribute(file, supply);
  for (int written = 0; written < 16 && !supply.empty(); ++written) write_dataset(file, supply);
  H5Fclose(file);
  fuzz::read_hdf5(input, path);
  return 0;
}
