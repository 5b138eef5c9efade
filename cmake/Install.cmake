# cmake --install: libraries, headers, the program, the kernels as data for CLARAY_KERNEL_DIR, and the package files with
# which find_package(claray) gives claray::claray, claray::io, claray::c, claray::verify and claray::accuracy.
# Components: library (the shared one), development, program, mpi, import, license.
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/claray")

if(BUILD_SHARED_LIBS)
    set_target_properties(claray_shared PROPERTIES EXPORT_NAME claray VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
    install(TARGETS claray_shared EXPORT claray LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
else()
    foreach(part IN LISTS claray_parts)
        string(REPLACE "claray_" "" name ${part})
        set_target_properties(${part} PROPERTIES EXPORT_NAME ${name})
    endforeach()
    install(TARGETS ${claray_parts} EXPORT claray ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
endif()
install(EXPORT claray FILE claray-targets.cmake NAMESPACE claray:: DESTINATION "${package_dir}" COMPONENT development)
export(EXPORT claray FILE "${CMAKE_CURRENT_BINARY_DIR}/claray-targets.cmake" NAMESPACE claray::)  # claray_DIR=build works, too
configure_package_config_file(cmake/claray-config.cmake.in claray-config.cmake INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file(claray-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/claray-config.cmake" "${CMAKE_CURRENT_BINARY_DIR}/claray-config-version.cmake"
        DESTINATION "${package_dir}" COMPONENT development)

# For C and for builds without CMake: pkg-config --cflags --libs claray. What claray stands on is named by its own .pc file where it
# has one. Whoever links static libraries needs all of it; whoever links the shared one needs the loader that CLHPP calls.
find_package(PkgConfig REQUIRED)
set(pc_names "")
set(pc_links "")
foreach(entry tinyobjloader=tinyobjloader::tinyobjloader libpng=PNG::PNG libjpeg=JPEG::JPEG zlib=ZLIB::ZLIB pugixml=${claray_xml} draco=draco::draco
              meshoptimizer=meshoptimizer::meshoptimizer OpenEXR=OpenEXR::OpenEXR libwebp=${WEBP_LIBRARY})
    string(REGEX MATCH "^([^=]*)=(.*)" entry "${entry}")
    set(name "${CMAKE_MATCH_1}")
    set(linked "${CMAKE_MATCH_2}")
    if(NOT TARGET ${linked} AND NOT EXISTS "${linked}")
        continue()
    endif()
    pkg_check_modules(claray_pc_${name} QUIET "${name}")
    if(claray_pc_${name}_FOUND)
        list(APPEND pc_names ${name})
    elseif(TARGET ${linked})
        string(APPEND pc_links " $<TARGET_LINKER_FILE:${linked}>")
    endif()
endforeach()
string(APPEND pc_links " -lstdc++ -lm -lpthread -ldl")
list(JOIN pc_names ", " pc_names)
if(BUILD_SHARED_LIBS)
    set(pc_requires "OpenCL")
    set(pc_libs "-lclaray")
else()
    set(pc_requires "OpenCL, ${pc_names}")
    set(pc_libs "-lclaray_c -lclaray_io -lclaray${pc_links}")
endif()
configure_file(cmake/claray.pc.in "${CMAKE_CURRENT_BINARY_DIR}/claray.pc.in" @ONLY)
file(GENERATE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/claray.pc" INPUT "${CMAKE_CURRENT_BINARY_DIR}/claray.pc.in")
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/claray.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
install(FILES include/claray.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)

install(DIRECTORY include/claray DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(DIRECTORY kernels DESTINATION ${CMAKE_INSTALL_DATADIR}/claray COMPONENT development)
install(DIRECTORY include/claray/shared DESTINATION ${CMAKE_INSTALL_DATADIR}/claray/include/claray COMPONENT development)
# With what the documents refer to.
install(FILES README.md CHANGELOG.md CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT license)  # packages have a form of their own for it
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
install(DIRECTORY bench/results DESTINATION ${CMAKE_INSTALL_DOCDIR}/bench COMPONENT development)
install(FILES kernels/tuning.txt DESTINATION ${CMAKE_INSTALL_DOCDIR}/kernels COMPONENT development)
if(TARGET claray_program)
    # Its plugins have a folder of their own.
    set(plugins "${CMAKE_INSTALL_LIBDIR}/claray")
    file(RELATIVE_PATH plugins_from_bin "${CMAKE_INSTALL_FULL_BINDIR}" "${CMAKE_INSTALL_FULL_LIBDIR}/claray")
    set_target_properties(claray_program PROPERTIES INSTALL_RPATH "$ORIGIN/${plugins_from_bin}")
    install(TARGETS claray_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
    install(TARGETS claray-http LIBRARY DESTINATION ${plugins} COMPONENT program)
    if(TARGET claray-mpi)
        install(TARGETS claray-mpi LIBRARY DESTINATION ${plugins} COMPONENT mpi)
    endif()
    if(TARGET claray_import)
        install(TARGETS claray_import RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/claray COMPONENT import)
    endif()
endif()
# What the program tells of its options: completions of shells and the manual page.
if(TARGET claray_program AND NOT CMAKE_CROSSCOMPILING)
    set(told "${CMAKE_BINARY_DIR}/told")
    set(zsh site-functions)
    if(CMAKE_INSTALL_PREFIX STREQUAL "/usr" AND EXISTS /etc/debian_version)
        set(zsh vendor-completions)  # where Debian's zsh looks for those of packages
    endif()
    add_custom_command(
        OUTPUT "${told}/claray" "${told}/_claray" "${told}/claray.fish" "${told}/claray.1.gz"
        COMMAND ${CMAKE_COMMAND} -E make_directory "${told}"
        COMMAND claray_program completion bash > "${told}/claray"
        COMMAND claray_program completion zsh > "${told}/_claray"
        COMMAND claray_program completion fish > "${told}/claray.fish"
        COMMAND claray_program man > "${told}/claray.1"
        COMMAND gzip -9nf "${told}/claray.1"
        COMMENT "Writing completions and the manual page" VERBATIM)
    add_custom_target(claray_told ALL DEPENDS "${told}/claray.1.gz")
    install(FILES "${told}/claray" DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
    install(FILES "${told}/_claray" DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${zsh} COMPONENT program)
    install(FILES "${told}/claray.fish" DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
    install(FILES "${told}/claray.1.gz" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
endif()
if(PROJECT_IS_TOP_LEVEL)
    include(cmake/Package.cmake)
endif()
