# Libraries, all from Debian bookworm. The installed package reads this file, too, since our libraries are static.
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
# found by pkg-config, because its CMake package also requires the command line tools
pkg_check_modules(OpenImageIO REQUIRED IMPORTED_TARGET OpenImageIO)
pkg_check_modules(Tiff REQUIRED IMPORTED_TARGET libtiff-4)
find_package(OpenCVModules REQUIRED)
find_package(Ceres 2.1 REQUIRED)
pkg_check_modules(NLopt REQUIRED IMPORTED_TARGET nlopt_cxx)
find_package(ZLIB REQUIRED)
pkg_check_modules(TomlPlusPlus REQUIRED IMPORTED_TARGET tomlplusplus)
pkg_search_module(HDF5 REQUIRED IMPORTED_TARGET hdf5-serial hdf5)
# compression of NRRD and VTK XML data
find_package(BZip2 REQUIRED)
pkg_check_modules(PugiXml REQUIRED IMPORTED_TARGET pugixml)
pkg_check_modules(Lz4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(Lzma REQUIRED IMPORTED_TARGET liblzma)
# only its header, whose functions are inlined
pkg_check_modules(XxHash REQUIRED IMPORTED_TARGET libxxhash)
# only the hash functions of OpenSSL
pkg_check_modules(OpenSSLCrypto REQUIRED IMPORTED_TARGET libcrypto)
