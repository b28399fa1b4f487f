# cpack -G DEB (make package): a Debian package of the program, its image codecs, cases and data, shell completion and
# manual page, without libraries and headers for development.
install(FILES LICENSE DESTINATION share/doc/gladstone RENAME copyright COMPONENT debian EXCLUDE_FROM_ALL)
install(FILES CHANGELOG.md DESTINATION share/doc/gladstone COMPONENT debian EXCLUDE_FROM_ALL)

# Maintainer of the package: DEBFULLNAME and DEBEMAIL, as for Debian's own tools, or else the author of the last commit.
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(package_contact "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
else()
  execute_process(COMMAND git log -1 "--format=%an <%ae>" WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
                  OUTPUT_VARIABLE package_contact OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT package_contact)
  set(package_contact "The gladstone authors <authors@gladstone.invalid>")  # a copy without history
endif()

set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # cpack packs what is built, without building tests
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME gladstone)
set(CPACK_PACKAGE_CONTACT "${package_contact}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "synthetic BOS and PIV images by ray tracing, and their analysis")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program debian)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox, fonts-dejavu-core")  # without them commands draw no figures
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "gladstone renders synthetic images for background-oriented schlieren (BOS) and
particle image velocimetry (PIV), measures the displacement on them, quantifies
the error of every vector, and converts BOS vectors to density. It recommends
set-ups that meet given requirements.
The processor must support AVX2 and FMA.")
include(CPack)
