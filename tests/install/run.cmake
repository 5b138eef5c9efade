# Installs a build of claray to a fresh prefix, then configures, builds and runs a consumer that finds it there, and one
# that finds it in the folder of the build. With SHARED, first builds claray as shared libraries and as a part of the consumer, of the
# objects of the build where these are compiled in the same way:
#   cmake -DSOURCE_DIR= -DBINARY_DIR= -DWORK_DIR= -DGENERATOR= -DCXX= [-DSHARED=ON] -P run.cmake
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
    file(STRINGS "${BINARY_DIR}/CMakeCache.txt" flags REGEX "^CMAKE_(BUILD_TYPE|CXX_FLAGS[A-Z_]*):STRING=")
    list(TRANSFORM flags PREPEND "-D")
    set(ENV{CLARAY_REUSE} "${BINARY_DIR}")
    set(ENV{CLARAY_LAUNCHER} "${LAUNCHER}")
    run(${CMAKE_COMMAND} -S "${consumer}" -B "${whole}" -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} ${flags}
        "-DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CURRENT_LIST_DIR}/reuse" "-DCLARAY_SOURCE_DIR=${SOURCE_DIR}" -DBUILD_SHARED_LIBS=ON
        -DCLARAY_INSTALL=ON)
    run(${CMAKE_COMMAND} --build "${whole}" --parallel 2)
    run("${whole}/consumer")
    run(${CMAKE_COMMAND} --install "${whole}" --prefix "${prefix}")
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
set(ENV{CLARAY_KERNEL_DIR} "${prefix}/share/claray/kernels")
run("${WORK_DIR}/build/consumer")
message(STATUS "the consumer of ${prefix} runs")
