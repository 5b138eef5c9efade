# Installs a build of claray to a fresh prefix, then configures, builds and runs a consumer that finds it there, and one
# that finds it in the folder of the build. With SHARED, first builds claray as shared libraries and as a part of the consumer, as far as
# the consumer needs it:
#   cmake -DSOURCE_DIR= -DBINARY_DIR= -DWORK_DIR= -DGENERATOR= -DCXX= -DCC= -DPKG_CONFIG= -DLIBDIR= [-DSHARED=ON] -P run.cmake
function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
    if(NOT status EQUAL 0)
        list(JOIN ARGN " " command)
        message(FATAL_ERROR "exit ${status} of: ${command}\n${log}")
    endif()
endfunction()

set(consumer "${CMAKE_CURRENT_LIST_DIR}/consumer")
set(prefix "${WORK_DIR}/prefix")
# Without optimizing and without -g, which nobody needs here, it builds fastest.
set(options -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
file(REMOVE_RECURSE "${WORK_DIR}")

if(SHARED)
    set(whole "${WORK_DIR}/as_subdirectory")
    run(${CMAKE_COMMAND} -S "${consumer}" -B "${whole}" ${options} "-DCLARAY_SOURCE_DIR=${SOURCE_DIR}" -DBUILD_SHARED_LIBS=ON
        -DCLARAY_INSTALL=ON -DCLARAY_BUILD_VERIFY=OFF -DCLARAY_QUICK_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=24)  # in two thirds of the time of 8
    run(${CMAKE_COMMAND} --build "${whole}" --parallel 2)
    run("${whole}/consumer")
    run(${CMAKE_COMMAND} --install "${whole}" --prefix "${prefix}")
    # It shows the public interface of C++ and C, and has a version.
    execute_process(COMMAND nm -DC --defined-only "${prefix}/${LIBDIR}/libclaray.so" OUTPUT_VARIABLE symbols RESULT_VARIABLE status)
    string(REGEX REPLACE "[0-9a-f]* [A-Za-z] (CLARAY_0.1|claray_|claray::[A-Z]|claray::detail::|claray::[a-z_]+[[(@]|(vtable|typeinfo|typeinfo name) for claray::)[^\n]*\n"
                         "" strangers "${symbols}")
    if(NOT status EQUAL 0 OR NOT symbols MATCHES " claray_bvh_build@" OR NOT symbols MATCHES " claray::Bvh::build[(]" OR NOT strangers STREQUAL "")
        message(FATAL_ERROR "libclaray.so shows more than its headers: ${strangers}")
    endif()
    execute_process(COMMAND readelf -d "${prefix}/${LIBDIR}/libclaray.so" OUTPUT_VARIABLE facts)
    if(NOT facts MATCHES "soname: [[]libclaray.so.0[]]")
        message(FATAL_ERROR "libclaray.so has another name: ${facts}")
    endif()
    file(REMOVE_RECURSE "${whole}")
else()
    run(${CMAKE_COMMAND} --install "${BINARY_DIR}" --prefix "${prefix}")
endif()

run(${CMAKE_COMMAND} -S "${consumer}" -B "${WORK_DIR}/build" ${options} "-DCMAKE_PREFIX_PATH=${prefix}")
run(${CMAKE_COMMAND} --build "${WORK_DIR}/build")
run("${WORK_DIR}/build/consumer")
if(NOT SHARED)
    run("${prefix}/bin/claray" devices)
    file(STRINGS "${WORK_DIR}/build/CMakeCache.txt" found REGEX "^claray_DIR:PATH=${prefix}/")
    if(NOT found)
        message(FATAL_ERROR "the consumer found another claray than the installed one")
    endif()
    foreach(file README.md LICENSE docs/formats.md)
        if(NOT EXISTS "${prefix}/share/doc/claray/${file}")
            message(FATAL_ERROR "${file} is not installed")
        endif()
    endforeach()
    # The folder of a build serves as a package, too.
    run(${CMAKE_COMMAND} -S "${consumer}" -B "${WORK_DIR}/of_build" ${options} "-Dclaray_DIR=${BINARY_DIR}")
    run(${CMAKE_COMMAND} --build "${WORK_DIR}/of_build")
    run("${WORK_DIR}/of_build/consumer")
endif()
# A program in C finds it by pkg-config.
if(PKG_CONFIG AND CC)
    execute_process(COMMAND ${CMAKE_COMMAND} -E env "PKG_CONFIG_PATH=${prefix}/${LIBDIR}/pkgconfig" ${PKG_CONFIG} --cflags --libs claray
                    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status ERROR_VARIABLE log)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "pkg-config does not find claray: ${log}")
    endif()
    separate_arguments(flags UNIX_COMMAND "${flags}")
    run(${CC} -std=c99 -Wall -Wextra -pedantic -Werror "${CMAKE_CURRENT_LIST_DIR}/consumer/main.c" -o "${WORK_DIR}/consumer_c" ${flags})
    run(${CMAKE_COMMAND} -E env "LD_LIBRARY_PATH=${prefix}/${LIBDIR}" "${WORK_DIR}/consumer_c")
endif()
set(ENV{CLARAY_KERNEL_DIR} "${prefix}/share/claray/kernels")
run("${WORK_DIR}/build/consumer")
message(STATUS "the consumer of ${prefix} runs")
