# cmake --install: libraries, headers, the program, the kernels as data for CLARAY_KERNEL_DIR, and the package files with
# which find_package(claray) gives claray::claray, claray::io, claray::verify and claray::accuracy.
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/claray")

set_target_properties(claray PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set_target_properties(claray_io PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                                           EXPORT_NAME io INSTALL_RPATH "$ORIGIN")
set(studying "")
if(CLARAY_BUILD_VERIFY)
    set(studying claray_verify claray_accuracy)
    set_target_properties(${studying} PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                                                 INSTALL_RPATH "$ORIGIN")
    set_target_properties(claray_verify PROPERTIES EXPORT_NAME verify)
    set_target_properties(claray_accuracy PROPERTIES EXPORT_NAME accuracy)
endif()
set_target_properties(claray_c PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                                          EXPORT_NAME c INSTALL_RPATH "$ORIGIN")
install(TARGETS claray claray_io claray_c ${studying} EXPORT claray
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT claray FILE claray-targets.cmake NAMESPACE claray:: DESTINATION "${package_dir}")
export(EXPORT claray FILE "${CMAKE_CURRENT_BINARY_DIR}/claray-targets.cmake" NAMESPACE claray::)  # claray_DIR=build works, too
configure_package_config_file(cmake/claray-config.cmake.in claray-config.cmake INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file(claray-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/claray-config.cmake" "${CMAKE_CURRENT_BINARY_DIR}/claray-config-version.cmake"
        DESTINATION "${package_dir}")

# For C and for builds without CMake: pkg-config --cflags --libs claray. Static libraries name all that they need.
set(pc_libs "-lclaray_c -lclaray_io -lclaray")
if(NOT BUILD_SHARED_LIBS)
    foreach(library OpenCL::OpenCL tinyobjloader::tinyobjloader PNG::PNG JPEG::JPEG ${claray_decoders})
        if(TARGET ${library})
            string(APPEND pc_libs " $<TARGET_LINKER_FILE:${library}>")
        else()
            string(APPEND pc_libs " ${library}")
        endif()
    endforeach()
    string(APPEND pc_libs " -lstdc++ -lm -lpthread -ldl")
endif()
configure_file(cmake/claray.pc.in "${CMAKE_CURRENT_BINARY_DIR}/claray.pc.in" @ONLY)
file(GENERATE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/claray.pc" INPUT "${CMAKE_CURRENT_BINARY_DIR}/claray.pc.in")
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/claray.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(FILES include/claray.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

install(DIRECTORY include/claray DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY kernels DESTINATION ${CMAKE_INSTALL_DATADIR}/claray)
install(DIRECTORY include/claray/shared DESTINATION ${CMAKE_INSTALL_DATADIR}/claray/include/claray)
# With what the documents refer to.
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY bench/results DESTINATION ${CMAKE_INSTALL_DOCDIR}/bench)
install(FILES kernels/tuning.txt DESTINATION ${CMAKE_INSTALL_DOCDIR}/kernels)
if(TARGET claray_program)
    file(RELATIVE_PATH lib_from_bin "${CMAKE_INSTALL_FULL_BINDIR}" "${CMAKE_INSTALL_FULL_LIBDIR}")
    set_target_properties(claray_program PROPERTIES INSTALL_RPATH "$ORIGIN/${lib_from_bin}")
    install(TARGETS claray_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
