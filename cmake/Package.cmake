# cpack: packages of Debian. ./dev deb configures for them: BUILD_SHARED_LIBS=ON and the prefix /usr.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The claray authors <claray@example.org>")
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL library development program mpi import)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(driver "pocl-opencl-icd | opencl-icd")
set(about "claray finds where rays meet surfaces, exactly and the same on every\ndevice, and renders by path tracing. CPUs and GPUs run the same kernels\nby OpenCL.")

# The day of the last change, so that a package is the same whenever it is made.
execute_process(COMMAND git log -1 --format=%aD WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT date)
    set(date "Thu, 01 Jan 1970 00:00:00 +0000")
endif()
file(READ "${PROJECT_SOURCE_DIR}/LICENSE" license)
string(REGEX REPLACE "\n\n" "\n.\n" license "${license}")
string(REGEX REPLACE "\n" "\n " license "${license}")
string(REGEX REPLACE "^MIT License\n \\.\n Copyright[^\n]*\n \\.\n" "" license "${license}")
string(STRIP "${license}" license)

# claray_package(COMPONENT NAME SECTION SUMMARY WHAT): a package of one component.
function(claray_package component name section summary what)
    string(TOUPPER ${component} upper)
    set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
    set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
    set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${about}\n.\n${what}" PARENT_SCOPE)
    set(folder "${CMAKE_BINARY_DIR}/packaging/${name}")
    file(WRITE "${folder}/copyright" "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: claray\n\n"
         "Files: *\nCopyright: 2026 The claray authors\nLicense: Expat\n ${license}\n")
    file(WRITE "${folder}/changelog" "claray (${PROJECT_VERSION}) unstable; urgency=medium\n\n  * See /usr/share/doc/claray/CHANGELOG.md of libclaray-dev.\n\n"
         " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
    execute_process(COMMAND gzip -9nf "${folder}/changelog")
    install(FILES "${folder}/copyright" "${folder}/changelog.gz" DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component}
            EXCLUDE_FROM_ALL)  # from cmake --install
endfunction()

claray_package(library libclaray${PROJECT_VERSION_MAJOR} libs "exact ray queries and path tracing by OpenCL (library)"
               "This package contains the shared library.")
claray_package(development libclaray-dev libdevel "exact ray queries and path tracing by OpenCL (development files)"
               "This package contains what programs in C++ and C are built with, the\nkernels and the documentation.")
claray_package(program claray graphics "exact ray queries and path tracing by OpenCL (program)"
               "This package contains the program claray.")
claray_package(mpi claray-mpi graphics "exact ray queries and path tracing by OpenCL (several machines)"
               "With this package claray renders one image on several machines.")
claray_package(import claray-import graphics "exact ray queries and path tracing by OpenCL (scenes of other programs)"
               "With this package claray reads FBX, COLLADA, 3DS and OFF.")
set(same "(= ${PROJECT_VERSION})")
# What packages of programs depend on that link it: the ABI may change with the minor version.
math(EXPR next_minor "${PROJECT_VERSION_MINOR} + 1")
set(library libclaray${PROJECT_VERSION_MAJOR})
file(WRITE "${CMAKE_BINARY_DIR}/packaging/shlibs" "libclaray ${PROJECT_VERSION_MAJOR} ${library} (>= ${PROJECT_VERSION}), ${library} (<< ${PROJECT_VERSION_MAJOR}.${next_minor})\n")
file(WRITE "${CMAKE_BINARY_DIR}/packaging/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${CMAKE_BINARY_DIR}/packaging/shlibs" "${CMAKE_BINARY_DIR}/packaging/triggers")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "${driver}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${library} ${same}, ocl-icd-opencl-dev | opencl-dev, opencl-clhpp-headers, \
libglm-dev")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "${driver}")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "claray-import, claray-mpi, libsdl2-2.0-0")
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "claray ${same}, openmpi-bin")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_NAME} built using CMake")  # CPack puts another one before those of the packages
include(CPack)
